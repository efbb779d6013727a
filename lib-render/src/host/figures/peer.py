"""Renders a glTF binary by Mitsuba 3 (variant llvm_ad_rgb), beside Jerboa and under the same rules.

Arguments: FILE SETTING, a JSON object with width, height, spp, max_depth, rr_depth, sampler, lanes (null for the best width) and
cache, a folder for what Dr.Jit compiles. Then a line of stdin is answered by a line of numbers:

- `load`: seconds of loading.
- `render SEED`: seconds of a render of the loaded scene.
- `variance`: variance of a sample, by the renders so far but those of seed 0.
- `whole SEED SPP PATH`: seconds from the opening of the file to the finished film, nothing being left of earlier renders, seconds
  of that after loading, and samples per pixel; the film's 32-bit floats go to PATH.

Box filter. Materials become what Mitsuba has: emitters, clear smooth glass, metals and mirrors with a
constant reflectance, Lambert for the rest. So only a scene that is made of these is the same integral.
"""

import ctypes
import glob
import json
import os
import struct
import sys
import tempfile
import time

# Dr.Jit keeps its cache in the home folder, which it asks for when it is imported.
SETTING = json.loads(sys.argv[2])
os.environ["HOME"] = SETTING["cache"]

import drjit as dr
import mitsuba as mi
import numpy as np

COMPONENTS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
NUMBERS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
NEAREST = 9728


def use_lanes(lanes):
    """Dr.Jit chooses the width of its vectors by the processor and has no other setting, but its library has."""
    library = ctypes.CDLL(os.path.join(os.path.dirname(dr.__file__), "libdrjit-core.so"))
    set_target = library._Z19jit_llvm_set_targetPKcS0_j
    set_target.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_uint32]
    set_target(b"skylake-avx512" if lanes == 16 else b"haswell", None, lanes)


class File:
    """A .glb: its JSON and its one buffer."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        length = struct.unpack_from("<I", data, 12)[0]
        self.folder = os.path.dirname(path)
        self.json = json.loads(data[20 : 20 + length])
        self.buffer = memoryview(data)[28 + length :]

    def list(self, name):
        return self.json.get(name, [])

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.buffer[start : start + view["byteLength"]]

    def accessor(self, index):
        a = self.json["accessors"][index]
        n, kind = NUMBERS[a["type"]], COMPONENTS[a["componentType"]]
        return np.frombuffer(self.view(a["bufferView"]), kind, a["count"] * n, a.get("byteOffset", 0)).reshape(-1, n)

    def placed(self):
        """Every node with its transform to the world."""
        scene = self.json["scenes"][self.json.get("scene", 0)]
        left = [(index, np.eye(4)) for index in scene["nodes"]]
        while left:
            index, parent = left.pop()
            node = self.json["nodes"][index]
            world = parent @ local(node)
            left += [(child, world) for child in node.get("children", [])]
            yield node, world


def local(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(turn) * node.get("scale", [1, 1, 1])
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def texture(file, index, channel):
    """Linear colour, decoded before it is filtered, or alpha as 0 and 1."""
    t = file.list("textures")[index]
    sampler = file.list("samplers")[t["sampler"]] if "sampler" in t else {}
    with tempfile.NamedTemporaryFile(suffix=".png") as image:
        image.write(file.view(file.list("images")[t["source"]]["bufferView"]))
        image.flush()
        texels = np.array(mi.Bitmap(image.name))
    if channel == "alpha":
        values = (texels[..., 3:4] >= 128).astype(np.float32)
    else:
        s = texels[..., :3].astype(np.float64) / 255
        values = np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4).astype(np.float32)
    nearest = sampler.get("magFilter") == NEAREST
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(values),
        "raw": True,
        "filter_type": "nearest" if nearest else "bilinear",
        "wrap_mode": "repeat",
        "format": "variant",
    }


def rgb(values):
    return {"type": "rgb", "value": [float(v) for v in values[:3]]}


def material(file, m):
    """A BSDF."""
    surface, extensions = m.get("pbrMetallicRoughness", {}), m.get("extensions", {})
    base = surface.get("baseColorFactor", [1, 1, 1, 1])
    if extensions.get("KHR_materials_transmission", {}).get("transmissionFactor", 0) > 0:
        ior = extensions.get("KHR_materials_ior", {}).get("ior", 1.5)
        return {"type": "dielectric", "int_ior": float(ior), "ext_ior": 1.0}
    if surface.get("metallicFactor", 1) > 0:
        alpha = surface.get("roughnessFactor", 1) ** 2
        rough = {"type": "roughconductor", "distribution": "ggx", "alpha": alpha}
        metal = rough if alpha > 0 else {"type": "conductor"}
        return {"type": "twosided", "bsdf": {**metal, "material": "none", "specular_reflectance": rgb(base)}}
    image = surface.get("baseColorTexture")
    colour = texture(file, image["index"], "colour") if image else rgb(base)
    lambert = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": colour}}
    if m.get("alphaMode") == "MASK" and image:
        return {"type": "mask", "opacity": texture(file, image["index"], "alpha"), "bsdf": lambert}
    return lambert


def write_ply(path, points, triangles, normals, uvs):
    columns, names = [points], ["x", "y", "z"]
    if normals is not None:
        columns, names = columns + [normals], names + ["nx", "ny", "nz"]
    if uvs is not None:
        columns, names = columns + [uvs], names + ["u", "v"]
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    lines += [f"property float {name}" for name in names]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(path, "wb") as ply:
        ply.write("\n".join(lines).encode())
        ply.write(np.concatenate(columns, 1).astype("<f4").tobytes())
        ply.write(faces.tobytes())


def shapes(file, folder):
    for node, world in file.placed():
        if "mesh" not in node:
            continue
        for primitive in file.list("meshes")[node["mesh"]]["primitives"]:
            at = {name: file.accessor(index) for name, index in primitive["attributes"].items()}
            points = at["POSITION"] @ world[:3, :3].T + world[:3, 3]
            normals = at.get("NORMAL")
            if normals is not None:
                normals = normals @ np.linalg.inv(world[:3, :3])
            corners = file.accessor(primitive["indices"]).reshape(-1, 3)
            path = tempfile.mktemp(".ply", dir=folder)
            write_ply(path, points, corners, normals, at.get("TEXCOORD_0"))
            m = file.list("materials")[primitive["material"]]
            shape = {"type": "ply", "filename": path, "face_normals": normals is None}
            shape["bsdf"] = {"type": "ref", "id": f"material{primitive['material']}"}
            strength = m.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
            radiance = np.array(m.get("emissiveFactor", [0, 0, 0])) * strength
            if radiance.any():
                shape["emitter"] = {"type": "area", "radiance": rgb(radiance)}
            yield shape


def environment(file):
    """Mitsuba has rows of texels on the poles, glTF's image between them: twice the rows hold the same function."""
    scene = file.json["scenes"][file.json.get("scene", 0)]
    named = scene.get("extras", {}).get("environment")
    if named is None:
        return None
    bitmap = mi.Bitmap(os.path.join(file.folder, named["uri"]))
    texels = np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    rows = np.empty((2 * len(texels) + 1, *texels.shape[1:]), np.float32)
    rows[1::2] = texels
    rows[0], rows[-1] = texels[0], texels[-1]
    rows[2:-1:2] = (texels[1:] + texels[:-1]) / 2
    turn = np.diag([-1.0, 1.0, -1.0, 1.0])
    scale = float(named.get("intensity", 1))
    return {"type": "envmap", "bitmap": mi.Bitmap(rows), "scale": scale, "to_world": mi.ScalarTransform4f(turn)}


def suns(file):
    """Directional lights."""
    lights = file.json.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
    for node, world in file.placed():
        index = node.get("extensions", {}).get("KHR_lights_punctual", {}).get("light")
        if index is not None and lights[index]["type"] == "directional":
            light = lights[index]
            direction = -world[:3, 2] / np.linalg.norm(world[:3, 2])
            irradiance = np.array(light.get("color", [1, 1, 1])) * light.get("intensity", 1)
            yield {"type": "directional", "direction": direction.tolist(), "irradiance": rgb(irradiance)}


def load(path, setting):
    file = File(path)
    node, world = next((n, w) for n, w in file.placed() if "camera" in n)
    yfov = file.list("cameras")[node["camera"]]["perspective"]["yfov"]
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": setting["max_depth"], "rr_depth": setting["rr_depth"]},
        "sensor": {
            "type": "perspective",
            "fov": float(np.degrees(yfov)),
            "fov_axis": "y",
            "near_clip": 1e-3,
            "far_clip": 1e5,
            "to_world": mi.ScalarTransform4f(world @ np.diag([-1.0, 1.0, -1.0, 1.0])),
            "film": {
                "type": "hdrfilm",
                "width": setting["width"],
                "height": setting["height"],
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": setting["sampler"], "sample_count": setting["spp"]},
        },
    }
    for i, m in enumerate(file.list("materials")):
        scene[f"material{i}"] = {**material(file, m), "id": f"material{i}"}
    sky = environment(file)
    if sky is not None:
        scene["sky"] = sky
    scene.update((f"sun{i}", sun) for i, sun in enumerate(suns(file)))
    with tempfile.TemporaryDirectory() as folder:
        scene.update((f"shape{i}", shape) for i, shape in enumerate(shapes(file, folder)))
        return mi.load_dict(scene)


def whole(path, setting, seed, target):
    """Wall times from the opening of the file, and samples per pixel. Nothing that an earlier scene left is used."""
    dr.flush_kernel_cache()
    for kernel in glob.glob(os.path.join(setting["cache"], ".drjit", "*")):
        os.remove(kernel)
    start = time.perf_counter()
    scene = load(path, setting)
    loaded = time.perf_counter()
    picture = np.array(mi.render(scene, seed=seed))
    end = time.perf_counter()
    picture.astype("<f4").tofile(target)
    return end - start, end - loaded, scene.sensors()[0].sampler().sample_count()


def main():
    path, setting = sys.argv[1], SETTING
    mi.set_variant("llvm_ad_rgb")
    if setting["lanes"]:
        use_lanes(setting["lanes"])
    scene, pictures = None, []
    for line in sys.stdin:
        start, words = time.perf_counter(), line.strip().split(" ", 3)
        if words[0] == "load":
            scene = load(path, setting)
            answer = [time.perf_counter() - start]
        elif words[0] == "variance":
            y = np.stack(pictures)
            answer = [setting["spp"] * y.var(axis=0, ddof=1).mean() / y.mean() ** 2]
        elif words[0] == "whole":
            answer = whole(path, {**setting, "spp": int(words[2])}, int(words[1]), words[3])
        else:
            seed = int(words[1])
            picture = np.array(mi.render(scene, spp=setting["spp"], seed=seed))
            answer = [time.perf_counter() - start]
            if seed > 0:
                pictures.append(picture.astype(np.float64) @ [0.2126, 0.7152, 0.0722])
        print(*answer, flush=True)


main()
