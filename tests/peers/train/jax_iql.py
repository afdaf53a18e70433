"""Implicit Q-learning in JAX, one jitted scan over the updates of a turn: python jax_iql.py SEEDS (more than one by vmap)."""

import sys
from functools import partial

import jax
import jax.numpy as jnp
import optax

import task


def network(key, inputs, outputs):
    init = jax.nn.initializers.orthogonal(2**0.5)
    keys = jax.random.split(key, 3)
    return [(init(k, s), jnp.zeros(s[1])) for k, s in zip(keys, task.layer_sizes(inputs, outputs))]


def forward(layers, x):
    for weight, bias in layers[:-1]:
        x = jax.nn.relu(x @ weight + bias)
    weight, bias = layers[-1]
    return x @ weight + bias


def scalar(layers, x):
    return forward(layers, x)[:, 0]


ADAM = optax.adam(task.RATE)
ACTOR_ADAM = optax.adam(optax.cosine_decay_schedule(task.RATE, task.STEPS))


def learner(key):
    keys = jax.random.split(key, 4)
    critic = [network(k, task.OBSERVATION + task.ACTION, 1) for k in keys[:2]]
    value = network(keys[2], task.OBSERVATION, 1)
    actor = (network(keys[3], task.OBSERVATION, task.ACTION), jnp.zeros(task.ACTION))
    return {
        "value": (value, ADAM.init(value)),
        "actor": (actor, ACTOR_ADAM.init(actor)),
        "critic": (critic, ADAM.init(critic)),
        "target": jax.tree.map(jnp.copy, critic),
    }


def descend(optimiser, loss, state):
    parameters, moments = state
    updates, moments = optimiser.update(jax.grad(loss)(parameters), moments)
    return optax.apply_updates(parameters, updates), moments


def update(data, state, key):
    index = jax.random.randint(key, (task.BATCH,), 0, task.ROWS)
    observation, action, reward, discount, following = (column[index] for column in data)
    pair = jnp.concatenate([observation, action], 1)
    q_target = jnp.minimum(*(scalar(head, pair) for head in state["target"]))

    def value_loss(value):
        u = q_target - scalar(value, observation)
        return (jnp.abs(task.TAU - (u < 0)) * u**2).mean()

    value = descend(ADAM, value_loss, state["value"])
    advantage = q_target - scalar(value[0], observation)
    weight = jnp.minimum(jnp.exp(task.BETA * advantage), task.ADVANTAGE_CLIP)

    def policy_loss(actor):
        mean, log_std = jnp.tanh(forward(actor[0], observation)), jnp.clip(actor[1], *task.LOG_STD)
        z = (action - mean) * jnp.exp(-log_std)
        return -(weight * (-0.5 * z**2 - log_std).sum(1)).mean()

    actor = descend(ACTOR_ADAM, policy_loss, state["actor"])
    y = reward + discount * scalar(value[0], following)

    def critic_loss(critic):
        return sum(((scalar(head, pair) - y) ** 2).mean() for head in critic)

    critic = descend(ADAM, critic_loss, state["critic"])
    target = optax.incremental_update(critic[0], state["target"], task.TARGET_RATE)
    return {"value": value, "actor": actor, "critic": critic, "target": target}


@partial(jax.jit, static_argnums=3, donate_argnums=1)
def scan(data, states, key, updates):
    """`updates` updates of every seed."""

    def one(states, key):
        if states["actor"][0][1].ndim == 1:
            return update(data, states, key), None
        seeds = states["actor"][0][1].shape[0]
        return jax.vmap(partial(update, data))(states, jax.random.split(key, seeds)), None

    return jax.lax.scan(one, states, jax.random.split(key, updates))[0]


def main(seeds):
    data = [jnp.asarray(column) for column in task.transitions()]
    key = jax.random.key(0)
    states = learner(key) if seeds == 1 else jax.vmap(learner)(jax.random.split(key, seeds))

    def run(updates):
        nonlocal states, key
        key, own = jax.random.split(key)
        states = jax.block_until_ready(scan(data, states, own, updates))

    task.serve(run)


main(int(sys.argv[1]))
