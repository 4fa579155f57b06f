// Compiled by itself, so that every caller shares one copy.

#include "arm_angles.h"

#include <algorithm>
#include <cmath>

#include "arm_lanes.h"

namespace kinesic::arm {

namespace {

constexpr double NARROW = 0.41421356237309504880;  // tangent of pi / 8

// Of a tangent within +-NARROW: a quotient of polynomials (Cephes, Moshier).
double small_arctangent(double t) {
    const double z = t * t;
    const double p = -6.485021904942025371773e1 +
                     z * (-1.228866684490136173410e2 +
                          z * (-7.500855792314704667340e1 +
                               z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1)));
    const double q = 1.945506571482613964425e2 +
                     z * (4.853903996359136964868e2 +
                          z * (4.328810604912902668951e2 +
                               z * (1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z))));
    return t + t * (z * p / q);
}

}  // namespace

Turn turn_of(double angle) {
    Lanes sine, cosine;
    sincos(all(angle), sine, cosine);
    return {cosine[0], sine[0]};
}

double arctangent(double y, double x) {
    const double across = std::fabs(y), along = std::fabs(x);
    const double less = std::min(across, along), more = std::max(across, along);
    double angle = 0.0;
    if (less > NARROW * more)
        angle = PI / 4.0 + small_arctangent((less - more) / (less + more));
    else if (more > 0.0)
        angle = small_arctangent(less / more);
    if (across > along) angle = PI / 2.0 - angle;
    if (std::signbit(x)) angle = PI - angle;
    return std::copysign(angle, y);
}

double arccosine(double x) { return 2.0 * arctangent(std::sqrt(1.0 - x), std::sqrt(1.0 + x)); }

}  // namespace kinesic::arm
