#include "study/peer_study.h"

namespace abbe {

// Arguments: scene, variant, folder, width, height, threads, seconds of the main curve, first seed, number of seeds,
// rungs with commas, samples of a half of the reference. It writes a PFM file for each part of a picture and says
//   abbe-peer version 3.9.1
//   abbe-peer part seed 1 64 64 0.51 0.98 /tmp/x/3.pfm     (kind, number, rung, samples, wall and processor seconds)
//   abbe-peer end seed 1
// Pictures are rendered in parts because some variants hold all samples in memory at once; their means are put together
// by the reader. Variants that compile do so in a render before the one whose time counts.
const char* const kMitsubaScript = R"python(
import os, sys, time

sys.path[:] = [folder for folder in sys.path if folder]  # what lies in the current folder is no module
import drjit as dr
import mitsuba as mi

scene_file, variant, folder = sys.argv[1:4]
width, height, threads = (int(v) for v in sys.argv[4:7])
main_seconds = float(sys.argv[7])
first_seed, seeds = int(sys.argv[8]), int(sys.argv[9])
rungs, reference = [int(v) for v in sys.argv[10].split(",")], int(sys.argv[11])
MOST_AT_ONCE = 1 << 22

def tell(*words):
    print("abbe-peer", *words, flush=True)

tell("version", mi.__version__)
if variant not in mi.variants():
    sys.exit(f"there is no variant `{variant}`; there are {', '.join(mi.variants())}")
mi.set_variant(variant)
mi.set_log_level(mi.LogLevel.Error)
dr.set_thread_count(threads)
scene = mi.load_file(scene_file)
if not scene.sensors():
    sys.exit("the scene has no sensor")
sensor = scene.sensors()[0]
parameters = mi.traverse(sensor)
for name, value in (("film.size", [width, height]), ("film.crop_size", [width, height]), ("film.crop_offset", [0, 0])):
    parameters[name] = mi.ScalarVector2u(value) if name != "film.crop_offset" else mi.ScalarPoint2u(value)
parameters.update()
compiled = set()
renders = 0

def measured(samples):
    global renders
    renders += 1
    seed = (first_seed * 1000003 + renders) & 0xffffffff
    wall, processor = time.perf_counter(), time.process_time()
    image = mi.render(scene, sensor=sensor, spp=samples, seed=seed)
    dr.eval(image)
    dr.sync_thread()
    return image, time.perf_counter() - wall, time.process_time() - processor

def render(kind, number, samples):
    done = wall = 0
    while done < samples:
        now = min(samples - done, max(1, MOST_AT_ONCE // (width * height)))
        if now not in compiled and not variant.startswith("scalar"):
            measured(now)
        compiled.add(now)
        image, seconds, processor = measured(now)
        path = os.path.join(folder, f"{renders}.pfm")
        bitmap = mi.Bitmap(image).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
        bitmap.write(path)
        taken = sensor.sampler().sample_count()  # some samplers take more than they are asked for
        tell("part", kind, number, samples, taken, seconds, processor, path)
        done += max(now, taken)
        wall += seconds
    return wall

def climb(number, ladder, until):
    before = last = 0
    for k, samples in enumerate(ladder):
        if until and k >= 2 and last + 2 * max(0, last - before) > max(0.25, 1.6 * main_seconds):
            ladder = ladder[:k]
            break
        before, last = last, render("seed", number, samples)
    tell("end", "seed", number)
    return ladder

rungs = climb(1, rungs, True)
for half in (1, 2):
    render("half", half, reference * rungs[-1])
    tell("end", "half", half)
for number in range(2, seeds + 1):
    climb(number, rungs, False)
)python";

} // namespace abbe
