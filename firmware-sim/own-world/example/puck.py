"""A puck on a table: two thrusters push it left or right, and back or forth, to a goal. 30 actions a second, each from 0 to 1."""
import math
import random

steps = 150
actions = 2
period_us = 33333


class Puck:
    pass


def make():
    return Puck()


def reset(puck, seed):
    chance = random.Random(seed)
    puck.place = [chance.uniform(-1, 1), chance.uniform(-1, 1)]
    puck.speed = [0.0, 0.0]
    puck.goal = [chance.uniform(-1, 1), chance.uniform(-1, 1)]
    return seen(puck)


def seen(puck):
    return puck.place + puck.speed + puck.goal


def step(puck, action):
    seconds = period_us / 1e6
    for axis in range(2):
        thrust = 4 * (min(max(action[axis], 0), 1) - 0.5)
        puck.speed[axis] = 0.96 * puck.speed[axis] + thrust * seconds
        puck.place[axis] += puck.speed[axis] * seconds
    distance = math.dist(puck.place, puck.goal)
    return seen(puck), -distance, distance < 0.1
