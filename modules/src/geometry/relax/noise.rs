//! Moves vertices at random, the same way for the same seed.
//!
//! A vertex moves by its place and the seed, not by its number: vertices at one place move together
//! where they move in all directions, and the order of the mesh does not matter.

use glam::DVec3;
use mve_core::{Cancelled, Control};
use mve_mesh::adjacency::Adjacency;
use mve_mesh::data::TriMesh;

use super::shading::renew_normals;
use crate::geometry::surface::normals::{NormalWeight, vertex_normals};

/// Where vertices move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseDirection {
    /// Along the normal of the vertex, out or in.
    Normal,
    /// Anywhere.
    All,
}

/// How far vertices move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// All distances up to the amplitude alike: along the normal, or within a ball.
    Uniform,
    /// The normal distribution whose standard deviation is the amplitude, along the normal or along
    /// each axis.
    Gaussian,
}

/// How to move the vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseOptions {
    /// What the random numbers start from.
    pub seed: u64,
    /// In model units.
    pub amplitude: f64,
    /// Where they move.
    pub direction: NoiseDirection,
    /// How far.
    pub spread: Spread,
}

/// A sequence of random numbers: G. Steele, D. Lea and C. Flood, "Fast splittable pseudorandom
/// number generators", OOPSLA 2014, figure 17 (SplitMix64).
struct Random(u64);

impl Random {
    /// Starts from a seed and a place.
    fn at(seed: u64, place: DVec3) -> Self {
        let mut random = Self(seed);
        for x in place.to_array() {
            // Adding 0 takes the sign of -0 away.
            random.0 = random.next() ^ (x + 0.0).to_bits();
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From −1 to below 1, by the upper 53 bits.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }

    /// With mean 0 and standard deviation 1: G. Box and M. Muller, "A note on the generation of
    /// random normal deviates", Annals of Mathematical Statistics 29(2), 1958.
    fn gaussian(&mut self) -> f64 {
        // From above 0 to 1, so that the logarithm is finite.
        let one = 0.5 - 0.5 * self.uniform();
        let angle = std::f64::consts::PI * self.uniform();
        (-2.0 * one.ln()).sqrt() * angle.cos()
    }

    /// Within the unit ball: from the cube around it, until one lies in it.
    fn in_ball(&mut self) -> DVec3 {
        loop {
            let point = DVec3::new(self.uniform(), self.uniform(), self.uniform());
            if point.length_squared() <= 1.0 {
                return point;
            }
        }
    }
}

/// The mean length of the edges, of those that are finite; 0 without any.
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn mean_edge(mesh: &TriMesh, control: Control) -> Result<f64, Cancelled> {
    let adjacency = Adjacency::new(mesh, control)?;
    let length = |[a, b]: &[mve_mesh::data::VertexId; 2]| {
        mesh.positions[a.idx()].distance(mesh.positions[b.idx()])
    };
    let lengths = adjacency.edges().iter().map(length).filter(|length| length.is_finite());
    let (sum, n) = lengths.fold((0.0, 0.0), |(sum, n), length| (sum + length, n + 1.0));
    Ok(if n > 0.0 { sum / n } else { 0.0 })
}

/// Moves the vertices; faces and layers stay, and normals are computed anew. A vertex without a
/// normal, or that is not finite, stays where it is to move along its normal, as does one that is
/// not among `chosen` where that is given. O(n).
///
/// # Errors
/// [`Cancelled`] when `control` says so.
pub fn add_noise(
    mut mesh: TriMesh,
    options: &NoiseOptions,
    chosen: Option<&[bool]>,
    control: Control,
) -> Result<TriMesh, Cancelled> {
    let normals = match options.direction {
        NoiseDirection::Normal => {
            vertex_normals(&mesh, NormalWeight::Angle, control.part(0.0, 0.4))?
        }
        NoiseDirection::All => Vec::new(),
    };
    let n_vertices = mesh.positions.len();
    for (vertex, position) in mesh.positions.iter_mut().enumerate() {
        control.part(0.4, 0.7).item(vertex, n_vertices)?;
        if chosen.is_some_and(|chosen| !chosen[vertex]) {
            continue;
        }
        let mut random = Random::at(options.seed, *position);
        let way = match (options.spread, normals.get(vertex)) {
            (Spread::Uniform, Some(normal)) => random.uniform() * *normal,
            (Spread::Gaussian, Some(normal)) => random.gaussian() * *normal,
            (Spread::Uniform, None) => random.in_ball(),
            (Spread::Gaussian, None) => {
                DVec3::new(random.gaussian(), random.gaussian(), random.gaussian())
            }
        };
        *position += options.amplitude * way;
    }
    renew_normals(&mut mesh, control.part(0.7, 1.0))?;
    Ok(mesh)
}

#[cfg(test)]
mod tests {
    use mve_mesh::fixtures::{cube, mesh_of};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::edit::checks::any_mesh;
    use crate::geometry::generate::{PlaneOptions, plane};

    const OPTIONS: NoiseOptions = NoiseOptions {
        seed: 7,
        amplitude: 0.1,
        direction: NoiseDirection::Normal,
        spread: Spread::Uniform,
    };

    fn noisy(mesh: &TriMesh, options: NoiseOptions) -> TriMesh {
        add_noise(mesh.clone(), &options, None, Control::none()).unwrap()
    }

    /// How far each vertex moved, over the amplitude.
    fn ways(options: NoiseOptions) -> Vec<DVec3> {
        let mesh = plane(&PlaneOptions { segments: [100, 100], ..PlaneOptions::DEFAULT });
        let found = noisy(&mesh, options);
        let pairs = found.positions.iter().zip(&mesh.positions);
        pairs.map(|(to, from)| (*to - *from) / options.amplitude).collect()
    }

    fn mean(values: impl Iterator<Item = f64>) -> f64 {
        let values: Vec<f64> = values.collect();
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Means of 10,201 numbers; four standard errors are allowed.
    #[test]
    fn distances_are_spread_as_they_are_said_to_be() {
        let along = ways(OPTIONS);
        assert!(along.iter().all(|way| way.truncate().length() < 1e-12 && way.z.abs() <= 1.0));
        assert!(mean(along.iter().map(|way| way.z)).abs() < 0.024);
        // The variance of a uniform number from -1 to 1 is 1/3.
        assert!((mean(along.iter().map(|way| way.z * way.z)) - 1.0 / 3.0).abs() < 0.012);
        let gaussian = ways(NoiseOptions { spread: Spread::Gaussian, ..OPTIONS });
        assert!(mean(gaussian.iter().map(|way| way.z)).abs() < 0.04);
        assert!((mean(gaussian.iter().map(|way| way.z * way.z)) - 1.0).abs() < 0.056);
        // Beyond two standard deviations lie 4.55 % of them.
        let far = mean(gaussian.iter().map(|way| f64::from(way.z.abs() > 2.0)));
        assert!((far - 0.0455).abs() < 0.0083, "{far}");
        let ball = ways(NoiseOptions { direction: NoiseDirection::All, ..OPTIONS });
        assert!(ball.iter().all(|way| way.length() <= 1.0 + 1e-12));
        // In a ball the mean distance from the center is 3/4.
        assert!((mean(ball.iter().map(|way| way.length())) - 0.75).abs() < 0.008);
    }

    #[test]
    fn seeds_differ_and_one_seed_is_one_result() {
        let other = NoiseOptions { seed: 8, ..OPTIONS };
        let mesh = cube(DVec3::ZERO);
        assert_eq!(noisy(&mesh, OPTIONS), noisy(&mesh, OPTIONS));
        assert_ne!(noisy(&mesh, OPTIONS), noisy(&mesh, other));
    }

    #[test]
    fn vertices_at_one_place_stay_together() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 0.0]];
        let mesh = mesh_of(&points, &[[0, 1, 2]]);
        let found = noisy(&mesh, NoiseOptions { direction: NoiseDirection::All, ..OPTIONS });
        assert_eq!(found.positions[0], found.positions[3]);
        assert_ne!(found.positions[0], DVec3::ZERO);
        // Without a face there is no normal to move along.
        assert_eq!(noisy(&mesh, OPTIONS).positions[3], DVec3::ZERO);
    }

    #[test]
    fn a_mean_edge_by_hand() {
        let mesh = mesh_of(&[[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]], &[[0, 1, 2], [2, 1, 0]]);
        assert_eq!(mean_edge(&mesh, Control::none()), Ok(4.0));
        assert_eq!(mean_edge(&TriMesh::default(), Control::none()), Ok(0.0));
    }

    proptest! {
        #[test]
        fn any_mesh_stays_a_mesh(
            mesh in any_mesh(),
            direction in prop_oneof![Just(NoiseDirection::Normal), Just(NoiseDirection::All)],
            spread in prop_oneof![Just(Spread::Uniform), Just(Spread::Gaussian)],
        ) {
            let found = noisy(&mesh, NoiseOptions { direction, spread, ..OPTIONS });
            prop_assert_eq!(found.check(), Ok(()));
            prop_assert_eq!(found.faces, mesh.faces);
        }
    }
}
