"""Stick-slip over infinitely many contacts that age at a temperature, for `core/tests/block/stick_slip.rs`.

Contacts with thresholds h = h_0 [1 + 0.02 ln(1 + age)], h_0 from G(1, 0.2), break at the rate
exp[-(h² - x²)/2T], T = 0.02, below their thresholds, at once when they reach them, and re-form unstretched.
The slider moves by 0.1 dX/dt = K(vt - X) - F, v = 1e-3. Contacts that formed in one step are a cohort, of
which the share left is followed at 200 fresh thresholds. Steps are implicit (backward Euler method, the net
force by the secant method); in a step ln(rate) is linear in time, and thresholds that are reached are those
of a part of a cell. A slip begins and ends at ten times the velocity of the load point.
"""

import math

import numpy as np

VELOCITY, DAMPING, TEMPERATURE, GROWTH, STD = 1e-3, 0.1, 0.02, 0.02, 0.2
CELLS, WIDEST = 200, 5.5
FAST = 10.0 * VELOCITY
# Longest step in time, per advance of a step in sliding.
LONGEST = 1e4
# The share of a cohort below which it is left out, and the accuracy of an advance.
GONE, PRECISE = 1e-14, 1e-10


class Cohorts:
    """Contacts by the step in which they formed."""

    def __init__(self) -> None:
        self.width = 2.0 * WIDEST * STD / CELLS
        self.fresh = 1.0 - WIDEST * STD + self.width * (np.arange(CELLS) + 0.5)
        share = np.exp(-0.5 * ((self.fresh - 1.0) / STD) ** 2)
        self.share = share / share.sum()
        self.origin, self.born, self.weight = np.zeros(1), np.zeros(1), np.ones(1)
        self.left = np.ones((1, CELLS))
        self.exponent = np.zeros((1, CELLS))
        self.rate = self.rates(self.fresh[None, :], 0.0)

    @staticmethod
    def rates(threshold: np.ndarray, stretch: np.ndarray | float) -> np.ndarray:
        """Rate of thermal breaking; 1 from the threshold on."""
        return np.exp(np.minimum(-0.5 * (threshold**2 - stretch**2) / TEMPERATURE, 0.0))

    def stepped(self, position: float, time: float, duration: float) -> tuple[float, float, tuple]:
        """Force and broken share after a step to a position and a time, and the state of the cohorts."""
        stretch = (position - self.origin)[:, None]
        growth = (1.0 + GROWTH * np.log1p(time - self.born))[:, None]
        rate = self.rates(self.fresh * growth, stretch)
        ratio = rate / self.rate
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = np.where(
                abs(ratio - 1.0) < 1e-3, 0.5 * (rate + self.rate), (rate - self.rate) / np.log(ratio)
            )
        exponent = self.exponent + mean * duration
        reached = np.clip((self.fresh + 0.5 * self.width - stretch / growth) / self.width, 0.0, 1.0)
        left = np.minimum(self.left, reached)
        after = (left * np.exp(-exponent)) @ self.share
        before = (self.left * np.exp(-self.exponent)) @ self.share
        broken = float(self.weight @ (before - after))
        return float(self.weight @ (after * stretch[:, 0])), broken, (left, exponent, rate, after)

    def force(self, position: float, time: float, moved: float, duration: float) -> float:
        """Force after a step; what breaks re-forms in its middle."""
        force, broken, _ = self.stepped(position + moved, time + duration, duration)
        return force + 0.5 * broken * moved

    def step(self, position: float, time: float, moved: float, duration: float) -> None:
        """Makes a step."""
        _, broken, (left, exponent, rate, after) = self.stepped(position + moved, time + duration, duration)
        kept = self.weight * after > GONE
        threshold = self.fresh * (1.0 + GROWTH * np.log1p(0.5 * duration))
        new = (np.ones(CELLS), np.zeros(CELLS), self.rates(threshold, 0.5 * moved))
        self.left, self.exponent, self.rate = (
            np.vstack([old[kept], row]) for old, row in zip((left, exponent, rate), new, strict=True)
        )
        self.origin = np.append(self.origin[kept], position + 0.5 * moved)
        self.born = np.append(self.born[kept], time + 0.5 * duration)
        self.weight = np.append(self.weight[kept], broken)


def advance(cohorts: Cohorts, state: tuple[float, float, float], duration: float, guess: float) -> float:
    """The advance in a step with forces in balance, of a slider at a position, a time and behind a spring."""
    position, time, stiffness = state
    tangent = DAMPING / duration + stiffness + 1.0

    def net(moved: float) -> float:
        pulled = stiffness * (VELOCITY * (time + duration) - position - moved)
        return pulled - DAMPING * moved / duration - cohorts.force(position, time, moved, duration)

    low, net_low = guess, net(guess)
    moved = low + net_low / tangent
    for _ in range(40):
        if abs(moved - low) < PRECISE:
            return moved
        here = net(moved)
        slope = (here - net_low) / (moved - low)
        low, net_low, moved = moved, here, moved - here / (slope if slope < 0.0 else -tangent)
    return math.inf


def slips(stiffness: float, distance: float, most: float) -> list[tuple[float, float, float]]:
    """Drive, force and force drop of the slips, in steps of about this advance."""
    cohorts, position, time = Cohorts(), 0.0, 0.0
    duration, velocity = 0.1, 0.0
    before, found = None, []
    while VELOCITY * time < distance:
        duration = min(LONGEST * most, 1.5 * duration, most / velocity if velocity > 0.0 else math.inf)
        moved = advance(cohorts, (position, time, stiffness), duration, velocity * duration)
        while not -1e-9 < moved < 2.0 * most:
            duration /= 3.0
            moved = advance(cohorts, (position, time, stiffness), duration, velocity * duration)
        cohorts.step(position, time, moved, duration)
        position, time, velocity = position + moved, time + duration, moved / duration
        force = stiffness * (VELOCITY * time - position) - DAMPING * velocity
        if before is None and velocity > FAST:
            before = (VELOCITY * time, force)
        elif before is not None and velocity < FAST:
            found.append((*before, before[1] - force))
            before = None
    return found


def main() -> None:
    """Prints the slips and the last period, which has errors of first order in the steps."""
    for stiffness, distance, most in [(0.01, 98.0, 1e-2), (0.01, 98.0, 5e-3), (0.02, 80.0, 1e-2)]:
        found = slips(stiffness, distance, most)
        print(f"K = {stiffness}, steps of {most}:", *(f"({x:.3f}, {f:.5f}, {d:.5f})" for x, f, d in found))
        if len(found) > 2:
            print(f"last period {found[-1][0] - found[-2][0]:.4f}")


if __name__ == "__main__":
    main()
