#pragma once
#include "sph/model/immiscible_liquids.hpp"
#include "sph/model/particles.hpp"

// Vectors of the viscous solve, [n][3], of the owned particles. Sums are this rank's.
namespace treacle::sph {

// (w a).(w a)
double sum_squares(const Array3& a, int n, const RelativeDensity& weight);

// a.b
double dot(const Array3& a, const Array3& b, int n);

// r = M u - product; returns r.r.
double subtract(const Array3& u, const RelativeDensity& inertia, const Array3& product, int n, const Array3& r);

// u += alpha p, r -= alpha q; returns r.r.
double step(double alpha, const Array3& p, const Array3& q, int n, const Array3& u, const Array3& r);

// p = z + beta p, rounded if it is for products in single precision; with beta = 0 whatever p was.
void turn(double beta, const Array3& z, int n, bool nearly, const Array3& p);

// a += c b
void add(double c, const Array3& b, int n, const Array3& a);

// to = from
void copy(const Array3& from, int n, const Array3& to);

// u = u* + (M u* - product) / M
void step_freely(const RelativeDensity& inertia, const Array3& product, int n, const Array3& u);

// The rows of particles that an inlet moves are M u = M u*: that velocity is prescribed.
void constrain_rows(
    const LiquidParticles& liquid, const RelativeDensity& inertia, const Array3& u, const Array3& product);

// Velocities to numbers of single precision, of which products in it are exact but for their differences. Not those that inlets
// hold: no direction would make up for that.
void round_free(const LiquidParticles& liquid);

} // namespace treacle::sph
