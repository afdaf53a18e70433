"""The fast engine: the same simulator, models, rewards and bits as the reference in `task.py`, with less around them.

What a step of the reference takes beside the physics is mostly the search for names, checks, copies, and arrays of one number. So

- the model is compiled without what can touch nothing and is never read: unnamed geoms for looks, cameras, lights;
- the package's own methods run over the scalar helpers of `scalars.py` (`rebound.py` says how);
- the methods that every step goes through are written out over windows on the simulator's memory;
- the first of two passes that bring the hand to its place at the start of an episode always starts from the same state, and is
  made once.

`test_fast.py` compares all 50 tasks with the reference, to the bit.
"""

import copy
import functools
import gc

import mujoco
import numpy as np

from quick import CURRENT, MOCAP_QUAT, observer
from rebound import rebound
from snapshot import Snapshot
from task import OBSERVATION, Task

# What the package reads before it sets a state of its own, which computes everything else anew.
STATE = ["qpos", "qvel", "qacc_warmstart", "ctrl", "mocap_pos", "mocap_quat"]
PLACES = ["xpos", "xquat", "xmat", "geom_xpos", "geom_xmat", "site_xpos", "site_xmat"]


class FastTask(Task):
    """A `Task` with the same bits in less time."""

    def _build(self, environment, simulator):
        initialize = _initialize_simulation if simulator is None else lambda env: simulator
        return rebound(environment, _initialize_simulation=initialize)(reward_function_version="v2")

    def _prepare(self):
        env = self.env
        _drive(env)
        self._hand_is_placed = False
        place_hand = env._reset_hand

        def reset_hand(steps=50):
            if self._hand_is_placed:
                self._hand_is_placed = False
            else:
                place_hand(steps)

        env._reset_hand = reset_hand
        # Whatever the package does to start an episode, it brings the hand to its place first.
        env._reset_hand()
        self._snapshot = Snapshot(env)
        data = env.data
        self._placed = [(window, window.copy()) for window in (getattr(data, name) for name in STATE + PLACES)]
        gc.freeze()

    def _restore(self):
        self._snapshot.restore()
        for window, kept in self._placed:
            np.copyto(window, kept)
        self._hand_is_placed = True


def _initialize_simulation(env):
    """What `MujocoEnv` does, with the model below."""
    model = copy.copy(_compiled(env.fullpath))
    return model, mujoco.MjData(model)


@functools.cache
def _compiled(path):
    """The model of a task without what has no part in its physics, its observations or its rewards."""
    spec = mujoco.MjSpec.from_file(path)
    for geom in list(spec.geoms):
        if geom.contype == 0 and geom.conaffinity == 0 and not geom.name:
            geom.delete()
    for looks in [*spec.cameras, *spec.lights]:
        looks.delete()
    model = spec.compile()
    # Nobody draws the bounding volumes either; to mark the active ones would clear 130 KB at every collision.
    model.vis.global_.bvactive = 0
    return model


def _drive(env):
    """Replaces what every step goes through, in this one environment."""
    model, data = env.model, env.data
    env.set_xyz_action = _mover(env)
    env._get_curr_obs_combined_no_goal = observer(env)
    hand = data.body("hand").xpos
    env.get_endeff_pos = lambda: hand
    env._get_obs = _stacker(env)
    env.touching_object = _toucher(data)
    env.do_simulation = _simulator(model, data)
    env.step = _stepper(env)
    env.get_body_com = {model.body(index).name: data.xpos[index] for index in range(model.nbody)}.__getitem__
    right, left = data.site("rightEndEffector").xpos, data.site("leftEndEffector").xpos
    type(env).tcp_center = property(lambda env: (right + left) / 2.0)


def _stepper(env):
    """`step`, up to the sites of the targets: it moves them, and the simulator puts them back at once."""
    model, data, ctrl = env.model, env.data, env.data.ctrl
    low, high = env.sawyer_observation_space.low, env.sawyer_observation_space.high
    frames, horizon = env.frame_skip, env.max_path_length

    def step(action):
        env.set_xyz_action(action[:3])
        ctrl[0] = action[3]
        ctrl[1] = -action[3]
        mujoco.mj_step(model, data, frames)
        env.curr_path_length += 1
        mujoco.mj_forward(model, data)
        observation = env._get_obs()
        np.maximum(observation, low, out=observation)
        np.minimum(observation, high, out=observation)
        reward, info = env.evaluate_state(observation, action)
        return observation, reward, False, env.curr_path_length == horizon, info

    return step


def _simulator(model, data):
    """`do_simulation` without the forces between bodies, which nobody reads."""
    ctrl = data.ctrl

    def do_simulation(control, frames):
        ctrl[:] = control
        mujoco.mj_step(model, data, frames)

    return do_simulation


def _mover(env):
    """`set_xyz_action`; like there, the product with the scale has 32 bits."""
    place, quaternion = env.data.mocap_pos[0], env.data.mocap_quat
    delta = np.empty(3, np.float32)

    def set_xyz_action(action):
        np.maximum(action, -1, out=delta)
        np.minimum(delta, 1, out=delta)
        np.multiply(delta, env.action_scale, out=delta)
        np.add(place, delta, out=place)
        np.maximum(place, env.mocap_low, out=place)
        np.minimum(place, env.mocap_high, out=place)
        quaternion[:] = MOCAP_QUAT

    return set_xyz_action


def _stacker(env):
    """`_get_obs`: now, one step ago, and the goal."""

    def observe():
        observation = np.empty(OBSERVATION)
        current = env._get_curr_obs_combined_no_goal()
        observation[:CURRENT] = current
        observation[CURRENT : 2 * CURRENT] = env._prev_obs
        observation[2 * CURRENT :] = env._target_pos
        env._prev_obs = current
        return observation

    return observe


def _toucher(data):
    """`touching_object`: whether both pads press on the object."""
    right_pad, left_pad = data.geom("rightpad_geom").id, data.geom("leftpad_geom").id

    def touching_object(object_geom):
        if data.ncon == 0:
            return False
        contacts = data.contact
        pairs = contacts.geom.tolist()
        touched = [row for row, pair in enumerate(pairs) if object_geom in pair]

        def force(pad):
            return sum(data.efc_force[contacts.efc_address[row]] for row in touched if pad in pairs[row])

        return 0 < force(left_pad) and 0 < force(right_pad)

    return touching_object
