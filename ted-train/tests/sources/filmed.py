"""Makes a folder of LeRobot 3 with the videos of two cameras, each picture of which says which one it is.

    filmed.py FOLDER [CODEC]     prints {first}: for each episode, which picture of its file is its first one

The number of a picture in its file stands over it in ten bits, white for 1, the highest one on the left. LeRobot's own codec is
`libsvtav1`, with every second picture a whole one.
"""

import json
import pathlib
import sys

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

import folders

WIDTH, HEIGHT, BITS = 320, 192, 10
CAMERAS = {"observation.images.top": (40, 90, 170), "observation.images.wrist": (170, 60, 40)}
# Episodes in the first file, all others are in the second.
SHARED = 5


def picture(number, colour):
    image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    image[:] = colour
    for bit in range(BITS):
        width = WIDTH // BITS
        image[: HEIGHT // 2, bit * width : (bit + 1) * width] = 255 * (number >> (BITS - 1 - bit) & 1)
    at = number * 4 % (WIDTH - 40)
    image[HEIGHT // 2 + 30 : HEIGHT // 2 + 70, at : at + 40] = 235
    return image


def film(path, pictures, colour, codec):
    path.parent.mkdir(parents=True, exist_ok=True)
    av.logging.set_level(av.logging.PANIC)
    with av.open(str(path), "w") as file:
        stream = file.add_stream(codec, rate=folders.FPS, options={"g": "2", "crf": "30"})
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        for number in range(pictures):
            for packet in stream.encode(av.VideoFrame.from_ndarray(picture(number, colour), "rgb24")):
                file.mux(packet)
        for packet in stream.encode():
            file.mux(packet)


def main(root, codec="libsvtav1"):
    root = pathlib.Path(root)
    frames = folders.all_frames(fixed=True)
    features = folders.FEATURES | {
        name: {"dtype": "video", "shape": [HEIGHT, WIDTH, 3], "names": ["height", "width", "channels"], "info": {"video.fps": folders.FPS}}
        for name in CAMERAS
    }
    about = {"codebase_version": "v3.0", "robot_type": "so101", "fps": folders.FPS, "features": features}
    about["data_path"] = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
    about["video_path"] = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
    (root / "meta/episodes/chunk-000").mkdir(parents=True)
    (root / "data/chunk-000").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(about))
    rows, first, pictures = [], [], [0, 0]
    for number, table in enumerate(frames):
        file = int(number >= SHARED)
        begin = pictures[file]
        pictures[file] += table.num_rows
        row = {"episode_index": number, "tasks": ["stack"], "length": table.num_rows, "data/chunk_index": 0, "data/file_index": 0}
        for name in CAMERAS:
            row |= {f"videos/{name}/chunk_index": 0, f"videos/{name}/file_index": file}
            row |= {f"videos/{name}/from_timestamp": begin / folders.FPS, f"videos/{name}/to_timestamp": pictures[file] / folders.FPS}
        rows.append(row)
        first.append(begin)
    pq.write_table(pa.concat_tables(frames), root / "data/chunk-000/file-000.parquet")
    pq.write_table(pa.Table.from_pylist(rows), root / "meta/episodes/chunk-000/file-000.parquet")
    for name, colour in CAMERAS.items():
        for file, count in enumerate(pictures):
            film(root / about["video_path"].format(video_key=name, chunk_index=0, file_index=file), count, colour, codec)
    json.dump({"first": first}, sys.stdout)


main(*sys.argv[1:])
