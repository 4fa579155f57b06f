// Height of wrinkles at each pixel, weighted by their action units (thesis 4.3.2); one texture of four maps.
uniform sampler2D form;
uniform sampler2D place;
uniform sampler2D maps;
uniform vec4 left;   // weight of each map on the left half of the face
uniform vec4 right;
uniform vec4 chart;  // scale and offset from chart to texture coordinates

const float MIDDLE = 0.15;  // half width of the blend between the halves

in vec2 uv;

out float height;  // added to the target

void main() {
    vec4 at = textureLod(place, uv, 0.0);
    vec4 shown = mix(right, left, smoothstep(-MIDDLE, MIDDLE, at.x));
    height = dot(shown, textureLod(maps, at.xy * chart.xy + chart.zw, 0.0));
    height *= on_skin(textureLod(form, uv, 0.0).w) ? max(at.z, 0.0) : 0.0;
}
