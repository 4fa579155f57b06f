// Thesis 4.3.2: height of all active wrinkles at each pixel, blended by the intensities of the action units.
uniform sampler2D position;
uniform sampler2D place;
uniform sampler2D maps0;
uniform sampler2D maps1;
uniform sampler2D maps2;
uniform vec4 left0;  // how much of each map is shown on the left half of the face
uniform vec4 left1;
uniform vec4 left2;
uniform vec4 right0;
uniform vec4 right1;
uniform vec4 right2;
uniform vec4 chart;    // maps place to texture: scale, then offset

const float MIDDLE = 0.15;  // half the width over which the halves change places

out float height;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 at = texelFetch(place, here, 0);
    vec2 uv = at.xy * chart.xy + chart.zw;
    float left = smoothstep(-MIDDLE, MIDDLE, at.x);
    float blend = dot(mix(right0, left0, left), texture(maps0, uv)) + dot(mix(right1, left1, left), texture(maps1, uv))
                + dot(mix(right2, left2, left), texture(maps2, uv));
    float skin = float(texelFetch(position, here, 0).w == 1.0);
    height = blend * at.z * skin;
}
