#pragma once
#include "base/text/vec3.hpp"
#include "flow/end_motion.hpp"
#include "sph/model/particles.hpp"

namespace treacle::sph {

// (S10) Velocities at the ends of steps, flow/end_motion.hpp. Of the owned particles; local.

// From particle `begin` on: end_velocity() is velocity(), rate() is gravity [m/s2]. What is pushed at once in its first step, as by
// an inlet, then has had a jump, and what falls has not.
void begin_velocities(const LiquidParticles& liquid, int begin, const Vec3& gravity);
// Before a step changes velocity(): notes it, in end_velocity().
void note_velocities(const LiquidParticles& liquid);
// After it: end_velocity() from velocity(), what was noted, and rate(), which is brought up to date.
void end_velocities(const LiquidParticles& liquid, const flow::StepTimes& times);

} // namespace treacle::sph
