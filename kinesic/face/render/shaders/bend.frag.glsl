// Normals bent by the wrinkles (M. S. Mikkelsen, Bump mapping unparametrized surfaces on the GPU, 2010, with central
// differences over the G-buffer).
uniform sampler2D form;
uniform sampler2D relief;
uniform vec2 lens;
uniform vec2 pixel;  // size in texture coordinates
uniform float bump;  // [m] height of a wrinkle of depth 1

const float EDGE = 0.006;  // [m] depth difference between separate surfaces
const float GRAZING = 0.2;  // cosine between stored and spanned normal below which the slope is unreliable

in vec2 uv;

out vec4 bent;  // packed as in the G-buffer

// Central difference along a screen axis; one-sided at an edge.
void slopes(vec2 step, float at, float height, out vec3 along, out float rise) {
    vec2 from = max(uv - step, 0.5 * pixel), to = min(uv + step, 1.0 - 0.5 * pixel);
    float before = textureLod(form, from, 0.0).w, after = textureLod(form, to, 0.0).w;
    float low = textureLod(relief, from, 0.0).r, high = textureLod(relief, to, 0.0).r;
    bool torn_before = abs(before - at) > EDGE, torn_after = abs(after - at) > EDGE;
    along = (torn_after ? position(uv, lens, at) : position(to, lens, after))
          - (torn_before ? position(uv, lens, at) : position(from, lens, before));
    rise = (torn_after ? height : high) - (torn_before ? height : low);
}

void main() {
    vec4 facing = textureLod(form, uv, 0.0);
    float height = textureLod(relief, uv, 0.0).r;
    vec3 n = facing.xyz, x, y;
    float rise_x, rise_y;
    slopes(vec2(pixel.x, 0.0), facing.w, height, x, rise_x);
    slopes(vec2(0.0, pixel.y), facing.w, height, y, rise_y);
    vec3 r1 = cross(y, n), r2 = cross(n, x), pull = rise_x * r1 + rise_y * r2;
    float det = dot(x, r1);
    bool grazed = det <= GRAZING * length(cross(x, y));
    bent = pull == vec3(0.0) || grazed ? facing : vec4(normalize(n - pull * (bump / det)), facing.w);
}
