//! What lies on the pictures of meshes: one file and one line an overlay.
//!
//! An overlay has lines on the surface, which the GPU draws with the faces, or paints over and
//! under the pictures, or stands on the whole panel, such as a color bar. With a switch it is
//! offered in the menu of the surface and kept from one start to the next.

use eframe::egui;

use super::lines::{LineChoice, LineSet};
use super::look::settings::{MeshSettings, Switch};
use super::scene::{MeshPicture, MeshScene};

/// Something that lies on the pictures of meshes. What paints and shows is called only while it is
/// switched on.
pub trait Overlay {
    /// How it is switched; `None` for what is always there.
    fn switch(&self) -> Option<Switch> {
        None
    }

    /// Lines on the surface.
    fn lines(&self) -> Option<&'static LineSet> {
        None
    }

    /// Paints behind or before the picture of one mesh.
    fn paint(&self, _layer: Depth, _picture: &MeshPicture) {}

    /// Shows what belongs to the whole panel, once all pictures are there.
    fn show(&mut self, _ui: &mut egui::Ui, _scene: &mut MeshScene) {}

    /// Gives up what is under way: called in each frame in which it is switched off.
    fn rest(&mut self) {}

    /// Whether something is in the making that will change what it shows.
    fn is_busy(&self) -> bool {
        false
    }
}

/// On which side of a picture something is painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Hidden by the mesh.
    Behind,
    /// Over it.
    Ahead,
}

/// Lists the overlays in the order in which they are painted and offered.
macro_rules! overlays {
    ($($file:ident::$overlay:ident,)*) => {
        $(mod $file;)*

        /// The state of all overlays.
        #[derive(Default)]
        pub struct Overlays {
            $($file: $file::$overlay,)*
        }

        impl Overlays {
            fn all(&self) -> Vec<&dyn Overlay> {
                vec![$(&self.$file,)*]
            }

            fn all_mut(&mut self) -> Vec<&mut dyn Overlay> {
                vec![$(&mut self.$file,)*]
            }
        }
    };
}

overlays! {
    wire::Wire,
    seams::Seams,
    border::Border,
    bounding_box::BoundingBox,
    axes::Axes,
    hover::Hover,
    distances::Distances,
    measure::Measure,
    picked::Picked,
    color_bar::ColorBar,
    captions::Captions,
    wipe::WipeLine,
}

impl Overlays {
    /// The switches that there are.
    pub fn switches(&self) -> Vec<Switch> {
        self.all().into_iter().filter_map(Overlay::switch).collect()
    }

    /// The kinds of lines, and which of them are shown.
    pub fn lines(&self, settings: &mut MeshSettings) -> Vec<LineChoice> {
        let choice = |overlay: &dyn Overlay| {
            Some(LineChoice { set: overlay.lines()?, is_on: is_on(overlay, settings) })
        };
        self.all().into_iter().filter_map(choice).collect()
    }

    /// Paints behind or before the picture of one mesh.
    pub fn paint(&self, layer: Depth, picture: &MeshPicture, settings: &mut MeshSettings) {
        for overlay in self.all() {
            if is_on(overlay, settings) {
                overlay.paint(layer, picture);
            }
        }
    }

    /// Shows what belongs to the whole panel.
    pub fn show(&mut self, ui: &mut egui::Ui, scene: &mut MeshScene) {
        for overlay in self.all_mut() {
            match is_on(overlay, scene.settings) {
                true => overlay.show(ui, scene),
                false => overlay.rest(),
            }
        }
    }

    /// Whether something is in the making that will change what is shown.
    pub fn is_busy(&self) -> bool {
        self.all().into_iter().any(Overlay::is_busy)
    }
}

fn is_on(overlay: &dyn Overlay, settings: &mut MeshSettings) -> bool {
    overlay.switch().is_none_or(|switch| *(switch.place)(settings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::mesh::gpu::MOST_LINE_SETS;

    #[test]
    fn the_shader_has_a_color_for_all_kinds_of_lines_and_switches_differ() {
        let overlays = Overlays::default();
        assert!(overlays.lines(&mut MeshSettings::default()).len() <= MOST_LINE_SETS);
        // Each switches itself alone.
        let switches = overlays.switches();
        for (at, switch) in switches.iter().enumerate() {
            let mut settings = MeshSettings::default();
            *(switch.place)(&mut settings) ^= true;
            for (other_at, other) in switches.iter().enumerate() {
                let is_as_before =
                    *(other.place)(&mut settings) == *(other.place)(&mut MeshSettings::default());
                assert_eq!(is_as_before, at != other_at, "{} {}", switch.label, other.label);
            }
        }
    }
}
