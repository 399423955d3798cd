// Compiled by grid_peer.py against the sources of rlguy/FLIPViscosity3D, never a part of the program: its example of a
// bunny that falls into a sphere, with other cells, viscosity and end. Prints a line a step: seconds, particles.
#include "fluidsimulation.h"
#include "trianglemesh.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

int main(int count, char** words) {
    if (count != 6) {
        std::fprintf(stderr, "usage: %s CELLS VISCOSITY STEP STEPS FOLDER_OF_MESHES\n", words[0]);
        return 2;
    }
    const int cells = std::atoi(words[1]), steps = std::atoi(words[4]);
    const float step = float(std::atof(words[3]));
    const std::string folder = words[5];
    FluidSimulation simulation;
    simulation.initialize(cells, cells, cells, 1.0f / float(cells));
    TriangleMesh bowl, bunny;
    if (!bowl.loadPLY(folder + "/sphere_large.ply") || !bunny.loadPLY(folder + "/stanford_bunny.ply")) return 1;
    simulation.addBoundary(bowl, true);
    simulation.addLiquid(bunny);
    simulation.setViscosity(float(std::atof(words[2])));
    simulation.setGravity(0, -9.81f, 0);
    for (int k = 0; k < steps; ++k) {
        const auto start = std::chrono::steady_clock::now();
        simulation.advance(step);
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        std::printf("step %d: %.4f s, %zu particles\n", k + 1, spent.count(), simulation.particles.size());
        std::fflush(stdout);
    }
    return 0;
}
