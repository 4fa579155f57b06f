// What the surface is at each pixel: its normal, bent by the wrinkles (M. S. Mikkelsen, Bump mapping unparametrized
// surfaces on the GPU, 2010, with central differences over the G-buffer), and its colour.
uniform sampler2D position;
uniform sampler2D normal;
uniform sampler2D place;
uniform sampler2D relief;
uniform sampler2D skin;   // painted in the chart; how dry it is
uniform sampler2D iris;   // painted round the axis of an eye
uniform vec4 chart;
uniform float bump;       // [m] of a wrinkle of depth 1
uniform vec3 hair;        // colour

const float EDGE = 0.006;  // [m] beyond this two pixels are not of one surface
const float SKIN = 1.0, EYES = 2.0, TEETH = 3.0, TONGUE = 4.0, LASHES = 5.0;
const float IRIS = 0.8;    // width of the painting, in radii of the eye
const vec3 GUMS = vec3(0.11, 0.028, 0.025);

out vec4 bent;    // unit normal; how deep in a furrow, 0 or below
out vec4 colour;  // square root of the linear; how much it shines

// Central difference along a screen axis; one-sided or none at an edge.
void slopes(ivec2 here, ivec2 step, vec4 at, float height, out vec3 along, out float rise) {
    vec4 before = texelFetch(position, here - step, 0), after = texelFetch(position, here + step, 0);
    float low = texelFetch(relief, here - step, 0).r, high = texelFetch(relief, here + step, 0).r;
    bool torn_before = before.w != at.w || abs(before.z - at.z) > EDGE;
    bool torn_after = after.w != at.w || abs(after.z - at.z) > EDGE;
    vec3 from = torn_before ? at.xyz : before.xyz, to = torn_after ? at.xyz : after.xyz;
    along = to - from;
    rise = (torn_after ? height : high) - (torn_before ? height : low);
}

float noise(vec2 p) {
    return fract(52.9829189 * fract(dot(floor(p), vec2(0.06711056, 0.00583715))));
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 at = texelFetch(position, here, 0);
    vec4 facing = texelFetch(normal, here, 0);
    vec4 where = texelFetch(place, here, 0);
    vec3 n = facing.xyz;
    float height = texelFetch(relief, here, 0).r;

    vec3 x, y;
    float rise_x, rise_y;
    slopes(here, ivec2(1, 0), at, height, x, rise_x);
    slopes(here, ivec2(0, 1), at, height, y, rise_y);
    vec3 r1 = cross(y, n), r2 = cross(n, x);
    float det = dot(x, r1);
    vec3 gradient = abs(det) > 1e-14 ? (rise_x * r1 + rise_y * r2) * (bump / det) : vec3(0.0);
    bent = vec4(normalize(n - gradient), min(height, 0.0));

    float mouth = at.w == TEETH ? smoothstep(0.0, 0.42, where.z) : smoothstep(-0.8, 0.5, where.z);  // it is dark in there
    vec2 uv = where.xy * chart.xy + chart.zw;
    if (at.w == SKIN) {
        vec4 painted = texture(skin, uv);
        float strand = noise(vec2(where.x * 150.0 + 6.0 * where.y, where.y * 9.0));
        float head = smoothstep(-0.06, 0.12, where.w + 0.09 * (strand - 0.5));
        vec3 base = mix(painted.rgb, hair * (0.6 + 0.8 * strand), head);
        base = mix(base, GUMS, facing.w);
        colour = vec4(base * (1.0 + 0.18 * min(height, 0.0)), mix(mix(0.75, 0.30, painted.a), 0.35, head));
        bent.xyz = normalize(bent.xyz + head * 0.5 * (strand - 0.5) * normalize(cross(n, vec3(0.0, 1.0, 0.001))));
    } else if (at.w == EYES) {
        vec2 ray = where.xy / IRIS * 0.5 + 0.5;
        float lid = 1.0 - 0.55 * smoothstep(0.05, 0.55, where.y) - 0.25 * smoothstep(0.35, 0.75, abs(where.x));
        colour = vec4(texture(iris, ray).rgb * lid, 1.0);
    } else if (at.w == TEETH) {
        colour = vec4(mix(GUMS, vec3(0.68, 0.63, 0.55), mouth), 0.8 * mouth);
    } else if (at.w == TONGUE) {
        colour = vec4(mix(GUMS, vec3(0.42, 0.12, 0.11), mouth), 0.5 * mouth);
    } else {
        colour = vec4(0.02, 0.014, 0.012, 0.05);
    }
    colour.rgb = sqrt(colour.rgb);
}
