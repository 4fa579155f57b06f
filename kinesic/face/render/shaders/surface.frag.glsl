// Colour of each pixel: painted skin and hair from the chart, otherwise the drawn colour.
uniform sampler2D place;
uniform sampler2D skin;  // square root of the painted colour; dryness
uniform vec4 chart;      // scale and offset from chart to texture coordinates
uniform vec3 hair;       // colour
uniform float level;     // mipmap level whose pixels match the screen

const vec3 CHEEKS = vec3(0.20, 0.055, 0.048);  // the inside of the lips
const vec3 THROAT = vec3(0.032, 0.008, 0.007);  // deep in the mouth
const float DEEP = 21.0;  // depth of full darkness, in the chart's depth unit
const float DULL = 0.8;   // fraction of gloss removed inside the mouth
const float LOCK = 3.0;  // [strands]
const vec2 STRANDS = vec2(150.0, 9.0);  // per unit of the chart

float noise(vec2 p) {
    return fract(52.9829189 * fract(dot(floor(p), vec2(0.06711056, 0.00583715))));
}

// Square root of the linear colour; gloss.
vec4 surface(vec2 uv, bool is_skin, float height) {
    vec4 where = textureLod(place, uv, 0.0);
    vec4 painted = textureLod(skin, where.xy * chart.xy + chart.zw, level);
    vec2 comb = vec2(where.x * STRANDS.x + 6.0 * where.y, where.y * STRANDS.y);
    float dense = fwidth(where.x) * STRANDS.x;  // strands per pixel; fine strands fade to locks, then vanish
    float strand = 0.5 + clamp(1.6 - dense, 0.0, 1.0) * (noise(comb) - 0.5)
                 + clamp(1.6 - dense / LOCK, 0.0, 1.0) * clamp(dense - 0.6, 0.0, 1.0) * (noise(comb / vec2(LOCK, 1.0)) - 0.5);
    float head = smoothstep(-0.03, 0.22, where.w + 0.03 * (strand - 0.5));
    vec3 base = mix(painted.rgb * painted.rgb, hair * (0.7 + 1.2 * mix(0.5, strand, head * head)), head);
    float inside = max(-where.z, 0.0), within = min(inside, 1.0), near = 1.0 - min(inside / DEEP, 1.0);
    base = mix(base, mix(THROAT, CHEEKS, near * near), within);
    base *= 1.0 + 0.18 * min(height, 0.0);
    vec4 skinned = vec4(sqrt(base), mix(mix(0.75, 0.30, painted.a), 0.35, head) * near * (1.0 - DULL * within));
    return is_skin ? skinned : where;
}
