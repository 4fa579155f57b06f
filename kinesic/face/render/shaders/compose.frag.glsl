// Picture: light times colour, encoded as sRGB.
const vec3 BRIGHT = vec3(0.299, 0.587, 0.114);

// sRGB pixel of linear light, and its brightness for edge detection.
vec4 shown(vec3 light) {
    light = light * (1.0 + light * 0.12) / (1.0 + light * 0.35);
    vec3 a = sqrt(clamp(light, 0.0, 1.0)), b = sqrt(a), c = sqrt(b);
    vec3 encoded = 0.585122381 * a + 0.783140355 * b - 0.368262736 * c;  // approximation of sRGB (error below 0.003)
    return vec4(encoded, dot(encoded, BRIGHT));
}

// Combines light before the surface colour, specular light, and the square root of the colour.
vec4 composed(vec4 lit, vec3 root) { return shown(lit.rgb * root * root + lit.a); }
