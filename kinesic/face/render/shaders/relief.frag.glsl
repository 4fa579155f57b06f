// Thesis 4.3.2: height of wrinkles at each pixel, as strong as their action units; one of three textures of four maps.
uniform sampler2D form;
uniform sampler2D place;
uniform sampler2D maps;
uniform vec4 left;   // how much of each map is shown on the left half of the face
uniform vec4 right;
uniform vec4 chart;  // maps place to texture: scale, then offset

const float MIDDLE = 0.15;  // half the width over which the halves change places

in vec2 uv;

out float height;  // added to what is there

void main() {
    vec4 at = textureLod(place, uv, 0.0);
    vec4 shown = mix(right, left, smoothstep(-MIDDLE, MIDDLE, at.x));
    height = dot(shown, textureLod(maps, at.xy * chart.xy + chart.zw, 0.0));
    height *= on_skin(textureLod(form, uv, 0.0).w) ? max(at.z, 0.0) : 0.0;
}
