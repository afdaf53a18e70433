"""Two intentions in one scene: two scripted policies play it, each after a purpose of its own, and one of them is the judge.

The scene is that of the first purpose's task. The second one's environment is built around the same simulator: it moves nothing,
but looks at the state, after every step, with its own observation and its own reward. So the judge changes no bit of what
happens, and an episode can be judged twice.

Nobody is told what is wanted: the goal's part of the observation is zero. Where a task draws its goal it is fixed here, so
that nothing is hidden but the purpose; what else is drawn at the start is drawn per episode as ever. The scripted policies know.

What was compared in metaworld 3.1.1: both faucet tasks have one model, one start and two observations, whose handle lies 3 cm apart;
the first one's range of places lies within the second's. The plate tasks differ in the place of a net alone, and without its net
`plate-slide-v3` is played as well as with it, while a plate pushed sideways needs one: the scene is that of
`plate-slide-side-v3`. Two of one task with two goals differ in a mark that nothing touches.
"""

from typing import NamedTuple

import mujoco
import numpy as np

GOAL = slice(36, 39)


class Purpose(NamedTuple):
    """What one of the two wants: a task and, where the task draws its goal, the goal instead."""

    task: str
    goal: tuple = ()


# Push and reach draw again, for ever if the goal is fixed, where the object lies within 15 cm of it: these goals are farther away.
SCENES = {
    "faucet-open_faucet-close": (Purpose("faucet-open-v3"), Purpose("faucet-close-v3")),
    "plate-slide-side_plate-slide": (
        Purpose("plate-slide-side-v3", (-0.3, 0.6, 0.0)),
        Purpose("plate-slide-v3", (0.0, 0.9, 0.0)),
    ),
    "push-left_push-right": (Purpose("push-v3", (-0.2, 0.85, 0.02)), Purpose("push-v3", (0.2, 0.85, 0.02))),
    "reach-left_reach-right": (Purpose("reach-v3", (-0.25, 0.8, 0.2)), Purpose("reach-v3", (0.25, 0.8, 0.2))),
}

# A task's name is its scene's and its judge's.
NAMES = {f"{scene}_{judge}": (scene, index) for scene in SCENES for index, judge in enumerate(["first", "second"])}


class Pair:
    """A task like any other to the session, with two purposes of which one judges."""

    purposes = 2

    def __init__(self, name, make):
        """`make` is the engine's class of tasks."""
        scene, self._judge = NAMES[name]
        self.name = name
        self._goals = [purpose.goal for purpose in SCENES[scene]]
        first, second = SCENES[scene]
        acted = make(first.task)
        model, data = acted.env.model, acted.env.data
        # An environment reads its first state when it is built.
        mujoco.mj_resetData(model, data)
        self._tasks = [acted, make(second.task, (model, data))]
        self._seen = [None, None]
        self.env, self.goal, self.horizon = acted.env, acted.goal, acted.horizon

    def scripted_policy(self, purpose=0):
        """The package's policy for one of the two, which sees its own task's observation in the place of the one it is given."""
        policy = self._tasks[purpose].scripted_policy()
        return lambda _hidden: policy(self._seen[purpose])

    def reset(self, seed):
        """Starts the episode of this seed and returns its first observation."""
        drawn = self._tasks[0].draw(seed)
        # The scene comes last: whatever the other one does to the simulator, it is undone.
        for task, goal in reversed(list(zip(self._tasks, self._goals, strict=True))):
            task.reset_to(np.concatenate([drawn[: drawn.size - len(goal)], goal]))
        for index, task in enumerate(self._tasks):
            now = task.env._prev_obs = task.env._get_curr_obs_combined_no_goal()
            self._seen[index] = np.concatenate([now, now, task.env._target_pos])
        return self._hidden()

    def step(self, action):
        """One control period: (observation, the judge's reward and success, terminated, truncated)."""
        acted, watching = self._tasks
        self._seen[0], *judged, terminated, truncated = acted.step(action)
        self._seen[1] = watching.look()
        for seen, task in zip(self._seen, self._tasks, strict=True):
            # A goal of ours may lie where the task itself draws none, and the package would clip it.
            seen[GOAL] = task.env._target_pos
        if self._judge == 1:
            judged = watching.judge(self._seen[1], action)
        return self._hidden(), *judged, terminated, truncated

    def marks(self):
        """Sites that show the goal: none, since nobody is told."""
        return []

    def _hidden(self):
        observation = self._seen[0].copy()
        observation[GOAL] = 0.0
        return observation
