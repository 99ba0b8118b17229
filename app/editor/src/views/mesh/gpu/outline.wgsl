// Draws lines of some pixels' width, each as a rectangle that faces the viewer.

struct Outline {
    clip_from_view: mat4x4<f32>,
    view_from_local: mat4x4<f32>,
    color: vec4<f32>,
    // Width and height of the picture in pixels, half of the width of a line in pixels, and how far
    // it is moved towards the viewer.
    numbers: vec4<f32>,
}

@group(0) @binding(0) var<uniform> o: Outline;

// Nearer to the eye than this there is no line.
const LEAST_W = 1e-6;

fn clip_of(position: vec3<f32>) -> vec4<f32> {
    let view = o.view_from_local * vec4(position, 1.0);
    let clip = o.clip_from_view * view;
    let nearer = o.clip_from_view * (view + vec4(0.0, 0.0, o.numbers.w, 0.0));
    // The place of the line, with the depth of one a little nearer: no stitching with the surface.
    if nearer.w > 0.0 {
        return vec4(clip.xy, max(nearer.z, 0.0) / nearer.w * clip.w, clip.w);
    }
    return clip;
}

// The end of a line, moved to where the line comes before the eye.
fn before_the_eye(end: vec4<f32>, other: vec4<f32>) -> vec4<f32> {
    if end.w >= LEAST_W {
        return end;
    }
    return mix(end, other, (LEAST_W - end.w) / (other.w - end.w));
}

@vertex
fn outline_vertex(
    @location(0) a: vec3<f32>,
    @location(1) b: vec3<f32>,
    @builtin(vertex_index) corner: u32,
) -> @builtin(position) vec4<f32> {
    let ends = array<vec4<f32>, 2>(clip_of(a), clip_of(b));
    if max(ends[0].w, ends[1].w) < LEAST_W {
        return vec4(0.0, 0.0, -1.0, 1.0);
    }
    let start = before_the_eye(ends[0], ends[1]);
    let stop = before_the_eye(ends[1], ends[0]);
    let size = o.numbers.xy;
    let along = (stop.xy / stop.w - start.xy / start.w) * size;
    let pixels = max(length(along), 1e-6);
    let direction = select(vec2(1.0, 0.0), along / pixels, pixels > 1e-5);
    let across = vec2(-direction.y, direction.x);
    // Longer by half of the width at each end, so that no joint gapes.
    let is_to = corner >= 2u;
    let at = select(start, stop, is_to);
    let ahead = select(-1.0, 1.0, is_to);
    let side = select(-1.0, 1.0, (corner & 1u) == 1u);
    let moved = (direction * ahead + across * side) * o.numbers.z * 2.0 / size;
    return vec4(at.xy + moved * at.w, at.zw);
}

@fragment
fn outline_fragment() -> @location(0) vec4<f32> {
    return vec4(o.color.rgb * o.color.a, o.color.a);
}
