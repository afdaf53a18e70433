"""Logs of the puck, some of them good: `python3 logs.py > logs.csv`. Nothing in them says which are good."""
import random

import puck

NAMES = "x y speed_x speed_y goal_x goal_y".split()


def pilot(seen, skill, chance):
    """Steers to the goal, and the less so the smaller the skill; at 0 it presses buttons."""
    place, speed, goal = seen[:2], seen[2:4], seen[4:]
    wanted = [0.5 + 1.5 * (goal[axis] - place[axis]) - 0.8 * speed[axis] for axis in range(2)]
    return [min(max(skill * wanted[axis] + (1 - skill) * chance.random(), 0), 1) for axis in range(2)]


print(",".join(["episode", "time_s", *NAMES, "thruster_x", "thruster_y"]))
for episode in range(100):
    chance = random.Random(episode)
    skill = chance.random() if episode % 10 else 1
    world = puck.make()
    seen = puck.reset(world, 1000 + episode)
    for number in range(puck.steps + 1):
        action = pilot(seen, skill, chance)
        row = [episode, number * puck.period_us / 1e6, *seen, *action]
        print(",".join(map(repr, row)))
        seen, _, _ = puck.step(world, action)
