#pragma once
#include "scene/sampling/signed_distance.hpp"
#include "scene/scene.hpp"

#include <array>

namespace treacle::app {

// A body that is as long as a period, a box or a cylinder along the axis: its ends meet those of its images, and there is no gap
// between. Where distances are taken and surfaces sampled it is longer by a period at both ends.
using Axes = std::array<bool, 3>;

// Axes along which a body spans a period; `region` is the body as the scene gives it.
Axes spanned_axes(const scene::Body& body, const scene::SolidRegion& region, const scene::Domain& domain);

// Shape of a body that spans these axes, lengthened by its images. A layer of samples `inset` [m] below its surface is three
// periods long, so that steps of a whole part of the period (periodic_spacing) go on through its ends.
scene::Shape with_images(scene::Shape shape, const Axes& spans, const scene::Domain& domain, double inset);

// Spacing nearest to d [m] of which the first of these periods is a multiple; d where there is no period.
double periodic_spacing(double d, const Axes& spans, const Vec3& min, const Vec3& max);

// True for a motion that may turn the body out of an axis.
bool may_turn(const scene::Body& body, std::size_t axis, int dimensions);

} // namespace treacle::app
