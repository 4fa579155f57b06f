// G-buffer of the skin.
in vec3 facing;
in vec4 placed;

layout(location = 0) out vec4 form;
layout(location = 1) out vec4 place;  // chart position, front mask or negative depth in the mouth, height over the hairline

void main() {
    form = vec4(normalize(facing), -1.0 / gl_FragCoord.w);
    place = placed;
}
