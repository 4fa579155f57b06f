// Averages several drawn pixels to one displayed pixel.
uniform sampler2D picture;
uniform float samples;

out vec4 shrunk;

void main() {
    int side = int(samples + 0.5);
    ivec2 corner = ivec2(gl_FragCoord.xy) * side;
    vec3 sum = vec3(0.0);
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) sum += texelFetch(picture, corner + ivec2(i, j), 0).rgb;
    shrunk = vec4(sum / float(side * side), 1.0);
}
