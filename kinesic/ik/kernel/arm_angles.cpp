// A separate compilation unit, so that every caller uses the same code.

#include "arm_angles.h"

#include <algorithm>
#include <cmath>

#include "arm_lanes.h"

namespace kinesic::arm {

namespace {

constexpr double TAN_PI_8 = 0.41421356237309504880;  // tangent of pi / 8

// Arc tangent of numbers within +-TAN_PI_8, by a rational function (Cephes, Moshier).
Lanes small_arctangent(Lanes t) {
    const Lanes z = t * t;
    const Lanes p = -6.485021904942025371773e1 +
                    z * (-1.228866684490136173410e2 +
                         z * (-7.500855792314704667340e1 +
                              z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1)));
    const Lanes q = 1.945506571482613964425e2 +
                    z * (4.853903996359136964868e2 +
                         z * (4.328810604912902668951e2 +
                              z * (1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z))));
    return t + t * (z * p / q);
}

}  // namespace

Turns turns_of(Lanes angle) {
    Turns turns;
    sincos(angle, turns.sine, turns.cosine);
    return turns;
}

Turn turn_of(double angle) {
    const Turns turns = turns_of(all(angle));
    return {turns.cosine[0], turns.sine[0]};
}

Lanes arctangent(Lanes y, Lanes x) {
    const Mask sign = Mask(all(-0.0));
    const Lanes across = magnitude(y), along = magnitude(x);
    const Mask steep = across > along;
    const Lanes less = either(steep, along, across), more = either(steep, across, along);
    const Mask wide = less > TAN_PI_8 * more;
    const Lanes part = either(wide, less - more, less), whole = either(wide, less + more, more);
    Lanes angle = only(wide, all(PI / 4.0)) + small_arctangent(only(more > 0.0, part / whole));
    angle = either(steep, PI / 2.0 - angle, angle);
    angle = either(Mask(x) < 0, PI - angle, angle);
    return Lanes(Mask(angle) | (Mask(y) & sign));
}

double arctangent(double y, double x) { return arctangent(all(y), all(x))[0]; }

double arccosine(double x) { return 2.0 * arctangent(std::sqrt(1.0 - x), std::sqrt(1.0 + x)); }

}  // namespace kinesic::arm
