"""A tank of liquid at rest: run once, and evaluated after its start has died away."""
import os
import sys

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "run"))
import harness
from harness import INPUTS, Workplace

GRAVITY, SPACING = 9.81, 0.02
SETTLED = 0.5  # [s]
ranks = 2


class TankAtRest(Workplace):
    scene, width = None, None  # the input's folder; of the tank [m]

    @classmethod
    def setUpClass(cls):
        cls.done = None

    def setUp(self):
        super().setUp()
        if type(self).done is None:
            self.run_scene(os.path.join(INPUTS, self.scene, "scene.yaml"), "run", ranks,
                           {"time.end": "0.8", "output.interval": "0.01"})
            # The liquid breathes a little, by millimetres per second: 31 frames over 0.3 s.
            frames = [self.frame("run", number) for number in range(-31, 0)]
            type(self).done = (frames, self.steps("run"), self.columns("run", "bodies.csv"))
        self.settled_frames, self.history, self.loads = type(self).done

    def slope(self, frame, low, high, of=True):
        """Of the pressure over the depth [Pa/m] between two heights, where no particle's support has a wall, the surface or an
        interface."""
        x, p = frame["position"], frame["pressure"]
        margin = 3 * SPACING
        bulk = (of & (x[:, 0] > margin) & (x[:, 0] < self.width - margin) & (x[:, 1] > low + margin)
                & (x[:, 1] < high - margin))
        self.assertGreater(bulk.sum(), 40)
        return -numpy.polyfit(x[bulk, 1], p[bulk], 1)[0]

    def carried(self):
        """The mean force on the walls, upwards [N/m]."""
        settled = self.loads["time [s]"] >= SETTLED
        sides = [name for name in self.loads.dtype.names if name.endswith("pressure force y [N/m]")]
        return -sum(self.loads[name][settled].mean() for name in sides)

    def fastest(self):
        settled = self.history["time [s]"] >= SETTLED
        return self.history["max speed [m/s]"][settled].max()


def main(usage):
    global ranks
    if len(sys.argv) < 4:
        sys.exit(usage)
    ranks = int(sys.argv.pop(3))
    harness.main(sys.argv, usage)
