// Normals bent by the wrinkles (M. S. Mikkelsen, Bump mapping unparametrized surfaces on the GPU, 2010, with central
// differences over the G-buffer).
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D relief;
uniform vec2 pixel;  // in texture coordinates
uniform float bump;  // [m] of a wrinkle of depth 1

const float EDGE = 0.006;  // [m] beyond this two pixels are not of one surface
const float GRAZING = 0.2;  // cosine between the normal and that of what the pixels span, below which they do not tell its slope

in vec2 uv;

out vec4 bent;  // unit; part + 1

// Central difference along a screen axis; one-sided or none at an edge.
void slopes(vec2 step, vec4 at, float height, out vec3 along, out float rise) {
    vec4 before = textureLod(position, uv - step, 0.0), after = textureLod(position, uv + step, 0.0);
    float low = textureLod(relief, uv - step, 0.0).r, high = textureLod(relief, uv + step, 0.0).r;
    bool torn_before = before.w != at.w || abs(before.z - at.z) > EDGE;
    bool torn_after = after.w != at.w || abs(after.z - at.z) > EDGE;
    vec3 from = torn_before ? at.xyz : before.xyz, to = torn_after ? at.xyz : after.xyz;
    along = to - from;
    rise = (torn_after ? height : high) - (torn_before ? height : low);
}

void main() {
    vec4 at = textureLod(position, uv, 0.0), facing = textureLod(normal, uv, 0.0);
    float height = textureLod(relief, uv, 0.0).r;
    vec3 n = normalize(facing.xyz), x, y;
    float rise_x, rise_y;
    slopes(vec2(pixel.x, 0.0), at, height, x, rise_x);
    slopes(vec2(0.0, pixel.y), at, height, y, rise_y);
    vec3 r1 = cross(y, n), r2 = cross(n, x), pull = rise_x * r1 + rise_y * r2;
    float det = dot(x, r1);
    bool grazed = det <= GRAZING * length(cross(x, y));
    bent = pull == vec3(0.0) || grazed ? facing : vec4(normalize(n - pull * (bump / det)), facing.w);
}
