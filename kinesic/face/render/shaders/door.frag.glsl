// Screen-door mask: whether a pixel of a surface with partial coverage is discarded.
bool hole(float share) {
    ivec2 at = ivec2(gl_FragCoord.xy) & 3;
    int mixed = at.x ^ at.y;
    int rank = (at.y & 1) | ((mixed & 1) << 1);
    rank = (rank << 2) | ((at.y >> 1) & 1) | (((mixed >> 1) & 1) << 1);
    return share <= (float(rank) + 0.5) / 16.0;
}
