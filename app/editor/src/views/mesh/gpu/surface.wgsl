// Draws surfaces and the lines on them. View space has z towards the viewer.

struct Uniforms {
    clip_from_view: mat4x4<f32>,
    view_from_local: mat4x4<f32>,
    // The color of a plain surface.
    surface: vec4<f32>,
    // The color that back faces are mixed with, and how much of it.
    back: vec4<f32>,
    // One for each kind of lines.
    line_colors: array<vec4<f32>, 8>,
    // Factor and offset from a value to its place in the table, whether what is outside is gray,
    // and how far lines are moved towards the viewer.
    numbers: vec4<f32>,
    // How what vertices carry is read, whether faces are flat.
    modes: vec4<u32>,
    // The plane of the section in view space: its normal, and how far it is from the eye along it.
    // What is farther along the normal is cut away.
    section: vec4<f32>,
}

const READ_NOTHING = 0u;
const READ_COLOR = 1u;
const READ_VALUE = 2u;
const READ_CHECKER = 3u;
const READ_PICTURE = 4u;
const READ_MATERIALS = 5u;

const TABLE_LENGTH = 1024.0;
const GRAY = vec3<f32>(0.5);

@group(0) @binding(0) var<uniform> u: Uniforms;
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var pictures: texture_2d_array<f32>;
@group(0) @binding(3) var clamping: sampler;
@group(0) @binding(4) var repeating: sampler;

struct SurfacePoint {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) carried: vec4<f32>,
    // The place of the texture among the pictures, below 0 for a color in its place.
    @location(3) @interpolate(flat) texture: i32,
}

@vertex
fn surface_vertex(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) words: vec2<u32>,
) -> SurfacePoint {
    let view = u.view_from_local * vec4(position, 1.0);
    var out: SurfacePoint;
    out.clip = u.clip_from_view * view;
    out.position = view.xyz;
    out.normal = (u.view_from_local * vec4(normal.xyz, 0.0)).xyz;
    out.texture = 0;
    if u.modes.x == READ_MATERIALS {
        out.texture = i32(round(normal.w * 32767.0));
    }
    if u.modes.x == READ_COLOR || out.texture < 0 {
        out.carried = unpack4x8unorm(words.x);
    } else {
        out.carried = vec4(bitcast<f32>(words.x), bitcast<f32>(words.y), 0.0, 0.0);
    }
    return out;
}

fn color_at(carried: vec4<f32>, texture: i32) -> vec3<f32> {
    // The first row of a picture is at the top, that of texture space at the bottom.
    let at = vec2(carried.x, 1.0 - carried.y);
    let across = dpdx(at);
    let down = dpdy(at);
    switch u.modes.x {
        case READ_COLOR: {
            // Corners without a color darken what they are mixed with by as much as they hide it.
            return carried.rgb + u.surface.rgb * (1.0 - carried.a);
        }
        case READ_VALUE: {
            let place = carried.x * u.numbers.x + u.numbers.y;
            // Below 1 as soon as one corner has no value.
            let is_number = carried.y > 0.999;
            let is_hidden = u.numbers.z > 0.5 && (place < 0.0 || place > 1.0);
            if !is_number || is_hidden {
                return GRAY;
            }
            let x = (clamp(place, 0.0, 1.0) * (TABLE_LENGTH - 1.0) + 0.5) / TABLE_LENGTH;
            return textureSampleLevel(table, clamping, vec2(x, 0.5), 0.0).rgb;
        }
        case READ_CHECKER: {
            let cell = floor(carried.xy * 16.0);
            let is_odd = abs(cell.x + cell.y) % 2.0 > 0.5;
            let hue = 0.12 * fract(carried.xy);
            return select(vec3(0.80, 0.82, 0.84), vec3(0.30, 0.42, 0.55) + vec3(hue, 0.0), is_odd);
        }
        case READ_PICTURE, READ_MATERIALS: {
            if texture < 0 {
                return carried.rgb;
            }
            return textureSampleGrad(pictures, repeating, at, texture, across, down).rgb;
        }
        default: {
            return u.surface.rgb;
        }
    }
}

fn lit(in: SurfacePoint, is_front: bool) -> vec4<f32> {
    // Rows count downward, so this points towards the viewer.
    let flat_normal = cross(dpdy(in.position), dpdx(in.position));
    var normal = in.normal;
    if !is_front {
        normal = -normal;
    }
    if u.modes.y == 1u || dot(normal, normal) < 1e-20 {
        normal = flat_normal;
    }
    normal = normalize(normal);
    var color = color_at(in.carried, in.texture);
    if !is_front {
        color = mix(color, u.back.rgb, u.back.a);
    }
    // A light at the camera, a little above its left shoulder.
    let light = normalize(vec3(-0.25, 0.4, 1.0));
    let diffuse = max(dot(normal, light), 0.0);
    let sky = 0.5 + 0.5 * normal.y;
    let halfway = normalize(light + vec3(0.0, 0.0, 1.0));
    let is_plain = u.modes.x == READ_NOTHING;
    let gloss = select(0.0, 0.14, is_plain) * pow(max(dot(normal, halfway), 0.0), 36.0);
    let light_of_all = color * (0.26 + 0.10 * sky + 0.68 * diffuse) + vec3(gloss);
    return vec4(clamp(light_of_all, vec3(0.0), vec3(1.0)), 1.0);
}

@fragment
fn surface_fragment(in: SurfacePoint, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    return lit(in, is_front);
}

fn is_cut_away(position: vec3<f32>) -> bool {
    return dot(u.section.xyz, position) > u.section.w;
}

// By itself, for whoever may discard writes depths late.
@fragment
fn cut_surface_fragment(in: SurfacePoint, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    let color = lit(in, is_front);
    if is_cut_away(in.position) {
        discard;
    }
    return color;
}

struct LinePoint {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec4<f32>,
    @location(1) position: vec3<f32>,
}

// The instance is the kind of lines.
@vertex
fn line_vertex(
    @location(0) position: vec3<f32>,
    @builtin(instance_index) instance: u32,
) -> LinePoint {
    let view = u.view_from_local * vec4(position, 1.0);
    let clip = u.clip_from_view * view;
    let nearer = u.clip_from_view * (view + vec4(0.0, 0.0, u.numbers.w, 0.0));
    var out: LinePoint;
    out.clip = clip;
    // The place of the line, with the depth of one a little nearer: no stitching with the surface.
    if nearer.w > 0.0 {
        out.clip.z = max(nearer.z, 0.0) / nearer.w * clip.w;
    }
    out.color = u.line_colors[instance];
    out.position = view.xyz;
    return out;
}

@fragment
fn line_fragment(in: LinePoint) -> @location(0) vec4<f32> {
    return vec4(in.color.rgb * in.color.a, in.color.a);
}

@fragment
fn cut_line_fragment(in: LinePoint) -> @location(0) vec4<f32> {
    if is_cut_away(in.position) {
        discard;
    }
    return vec4(in.color.rgb * in.color.a, in.color.a);
}
