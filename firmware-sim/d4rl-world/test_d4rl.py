"""D4RL's tasks: gymnasium's numbers for its own environments, and D4RL's for the maze."""

import pathlib
import sys
import unittest
import warnings

import gymnasium
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parent))

from antmaze import CELL, MAZES, AntMaze, cells  # noqa: E402
from locomotion import ENVIRONMENTS, Locomotion  # noqa: E402


class Locomotions(unittest.TestCase):
    def test_steps_are_those_of_gymnasium_until_the_episode_ends(self):
        for task, environment in ENVIRONMENTS.items():
            with self.subTest(task), warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                theirs = gymnasium.make(environment)
                world = Locomotion(task)
                ours = world.make()
                self.assertEqual((world.steps, world.actions), (theirs.spec.max_episode_steps, theirs.action_space.shape[0]))
                numpy.testing.assert_array_equal(world.reset(ours, 5), theirs.reset(seed=5)[0])
                chance = numpy.random.default_rng(7)
                ended = False
                for _ in range(200):
                    action = chance.uniform(-1, 1, world.actions).astype(numpy.float32)
                    observation, reward, terminated, _, _ = theirs.step(action)
                    mine = world.step(ours, action)
                    numpy.testing.assert_array_equal(mine[0], observation)
                    self.assertEqual(mine[1:], (reward, False, terminated))
                    ended = ended or terminated
                    if ended:
                        break
                # The cheetah cannot fall; a random hopper does at once.
                self.assertEqual(ended, task != "halfcheetah", task)

    def test_the_ant_has_no_contact_forces_in_its_observation(self):
        world = Locomotion("ant")
        self.assertEqual(len(world.reset(world.make(), 0)), 27)


class Mazes(unittest.TestCase):
    def test_the_mazes_are_d4rl_s(self):
        # Rows and columns, free cells, and the goal's cell from the start, in metres (d4rl/locomotion/maze_env.py).
        for task, size, free, goal in [
            ("antmaze-umaze", (5, 5), 7, (0, 8)),
            ("antmaze-medium", (8, 8), 26, (20, 20)),
            ("antmaze-large", (9, 12), 46, (32, 24)),
        ]:
            maze = MAZES[task]
            self.assertEqual((len(maze), len(maze[0])), size)
            self.assertTrue(all(len(row) == size[1] for row in maze))
            self.assertEqual(size[0] * size[1] - len(cells(maze, "W")), free, task)
            (start,), (end,) = cells(maze, "S"), cells(maze, "G")
            self.assertEqual(tuple(end - start), goal)

    def test_the_ant_has_d4rl_s_motors_and_clock(self):
        world = AntMaze("antmaze-umaze")
        ant = world.make()
        self.assertEqual((ant.model.nq, ant.model.nv, ant.model.nu), (15, 14, 8))
        self.assertEqual((ant.model.opt.timestep, world.period_us, world.steps), (0.02, 100_000, 700))
        world.reset(ant, 0)
        world.step(ant, [2.0, -1.0, 0.5] + [0.0] * 5)
        # Action 0 of D4RL's ant is the fourth hip; a command is clipped to the greatest torque.
        numpy.testing.assert_array_equal(ant.data.actuator_force[:3], [30.0, -30.0, 15.0])

    def test_an_episode_begins_at_the_origin_with_a_goal_in_its_cell_and_is_its_seed_s(self):
        world = AntMaze("antmaze-medium")
        ant = world.make()
        goals = set()
        for seed in range(50):
            seen = world.reset(ant, seed)
            self.assertLessEqual(abs(seen[:2]).max(), 0.1)
            beyond = ant.goal - [20, 20]
            self.assertTrue((beyond >= 0).all() and (beyond <= 1.5).all(), ant.goal)
            goals.add(tuple(ant.goal))
            numpy.testing.assert_array_equal(world.reset(ant, seed), seen)
        self.assertEqual(len(goals), 50)

    def test_whoever_is_near_the_goal_has_reached_it_and_nobody_else_has(self):
        world = AntMaze("antmaze-large")
        ant = world.make()
        for distance, reached in [(0.3, True), (0.8, False)]:
            world.reset(ant, 3)
            ant.data.qpos[:2] = ant.goal + [distance, 0]
            self.assertEqual(world.step(ant, numpy.zeros(8))[1:], (float(reached), reached, reached))

    def test_nobody_walks_through_a_wall(self):
        world = AntMaze("antmaze-umaze")
        ant = world.make()
        world.reset(ant, 0)
        # Thrown up, where the first wall is half a cell away; and to the right, where the way is free.
        for velocity, far in [((0, 6), False), ((6, 0), True)]:
            world.reset(ant, 0)
            for _ in range(10):
                ant.data.qvel[:2] = velocity
                world.step(ant, numpy.zeros(8))
            self.assertEqual(max(abs(ant.data.qpos[:2])) > CELL / 2, far, ant.data.qpos[:2])


if __name__ == "__main__":
    unittest.main()
