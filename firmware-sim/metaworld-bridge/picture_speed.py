"""How long a picture takes by each way, at the size and quality of `ted ask`: the median and the slowest of 50, after the first.

    picture_speed.py [TASK]        drawer-open-v3 if not given

Each way has a process of its own. Run it with the environment's Python; `docs/ask.md` has the figures.
"""

import os
import subprocess
import sys
import time

PICTURES = 50
WIDTH, HEIGHT, QUALITY = 400, 300, 80


def measure(way, name):
    os.environ["MUJOCO_GL"] = "disable"
    import render
    from task import Task

    begun = time.perf_counter()
    render.WAYS = (way,)
    render.open_way()
    task = Task(name)
    painter = render.Painter(task)
    ready = time.perf_counter() - begun
    task.reset(0)
    data = task.env.data
    state = [data.qpos.copy()], [data.mocap_pos.copy()], [data.mocap_quat.copy()]
    times, size = [], 0
    for _ in range(PICTURES + 1):
        begun = time.perf_counter()
        (jpeg,) = painter.pictures(0, WIDTH, HEIGHT, QUALITY, *state)
        times.append(1000 * (time.perf_counter() - begun))
        size = len(jpeg)
    del times[0]
    middle = sorted(times)[PICTURES // 2]
    print(f"{way:6}  ready in {ready:.1f} s, a picture {middle:.1f} ms, slowest {max(times):.1f} ms, {size} bytes")


def main(name="drawer-open-v3", way=None):
    if way is not None:
        measure(way, name)
        return
    import render

    for way in render.WAYS:
        ended = subprocess.run([sys.executable, __file__, name, way], capture_output=True, text=True)
        print(ended.stdout.strip() or f"{way:6}  {(ended.stderr.strip().splitlines() or ['failed'])[-1]}")


if __name__ == "__main__":
    main(*sys.argv[1:])
