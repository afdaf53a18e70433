"""Implicit Q-learning in eager PyTorch, as it is usually written: python torch_iql.py THREADS."""

import copy
import sys

import torch
from torch import nn

import task


def network(inputs, outputs):
    sizes = task.layer_sizes(inputs, outputs)
    layers = []
    for size in sizes:
        linear = nn.Linear(*size)
        nn.init.orthogonal_(linear.weight, 2**0.5)
        nn.init.zeros_(linear.bias)
        layers += [linear, nn.ReLU()]
    return nn.Sequential(*layers[:-1])


def main(threads):
    torch.set_num_threads(threads)
    torch.manual_seed(0)
    data = [torch.from_numpy(column) for column in task.transitions()]
    value, actor = network(task.OBSERVATION, 1), network(task.OBSERVATION, task.ACTION)
    log_std = nn.Parameter(torch.zeros(task.ACTION))
    critic = nn.ModuleList(network(task.OBSERVATION + task.ACTION, 1) for _ in range(2))
    target = copy.deepcopy(critic).requires_grad_(False)
    adam = lambda parameters: torch.optim.Adam(parameters, task.RATE)
    value_adam, critic_adam = adam(value.parameters()), adam(critic.parameters())
    actor_adam = adam([*actor.parameters(), log_std])
    cosine = torch.optim.lr_scheduler.CosineAnnealingLR(actor_adam, task.STEPS)

    def descend(optimiser, loss):
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()

    def update():
        index = torch.randint(0, task.ROWS, (task.BATCH,))
        observation, action, reward, discount, following = (column[index] for column in data)
        pair = torch.cat([observation, action], 1)
        with torch.no_grad():
            q_target = torch.min(*(head(pair)[:, 0] for head in target))
        u = q_target - value(observation)[:, 0]
        descend(value_adam, ((task.TAU - (u < 0).float()).abs() * u**2).mean())

        with torch.no_grad():
            advantage = q_target - value(observation)[:, 0]
            weight = (task.BETA * advantage).exp().clamp(max=task.ADVANTAGE_CLIP)
            y = reward + discount * value(following)[:, 0]
        clipped = log_std.clamp(*task.LOG_STD)
        z = (action - actor(observation).tanh()) * (-clipped).exp()
        descend(actor_adam, -(weight * (-0.5 * z**2 - clipped).sum(1)).mean())
        cosine.step()

        descend(critic_adam, sum(((head(pair)[:, 0] - y) ** 2).mean() for head in critic))
        with torch.no_grad():
            for old, new in zip(target.parameters(), critic.parameters()):
                old.lerp_(new, task.TARGET_RATE)

    task.serve(lambda updates: [update() for _ in range(updates)])


main(int(sys.argv[1]))
