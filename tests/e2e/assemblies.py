"""An assembly as a tree of nodes, written as 3MF, GLB and glTF, and the matrices that place its parts, in the order of operations of the
contract. A node is {"name", "shape" (a number) or none, "matrix" (12 numbers, row by row) or "trs", "children"}."""
import base64
import json
import math
import struct
import zipfile

import solids

IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def product(a, b):
    out = []
    for r in range(3):
        for c in range(4):
            v = (a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c]) + a[4 * r + 2] * b[8 + c]
            out.append(v + a[4 * r + 3] if c == 3 else v)
    return out


def of_trs(t, q, s):
    n = math.sqrt(((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3])
    x, y, z, w = (v / n for v in q)
    return [(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1], 2 * (x * z + y * w) * s[2], t[0],
            2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - x * w) * s[2], t[1],
            2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]]


def matrix_of(node):
    return node["matrix"] if "matrix" in node else of_trs(*node["trs"]) if "trs" in node else IDENTITY


def parts_of(nodes, above="", matrix=IDENTITY):
    """(path, shape, matrix) of each part, for trees whose siblings have different names."""
    for n in nodes:
        m, path = matrix_of(n), f"{above}/{n['name']}"
        m = m if matrix == IDENTITY else matrix if m == IDENTITY else product(matrix, m)
        if "shape" in n:
            yield path, n["shape"], m
        yield from parts_of(n.get("children", []), path, m)


def ball(around, along):
    """The facets of a closed surface of genus 0 and radius 1."""
    ring = [[(math.sin(math.pi * j / along) * math.cos(2 * math.pi * i / around), math.sin(math.pi * j / along) * math.sin(2 * math.pi * i / around),
              math.cos(math.pi * j / along)) for i in range(around)] for j in range(1, along)]
    top, bottom, out = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), []
    for i in range(around):
        k = (i + 1) % around
        out += [[top, ring[0][i], ring[0][k]], [bottom, ring[-1][k], ring[-1][i]]]
        for a, b in zip(ring, ring[1:]):
            out += [[a[i], b[i], b[k]], [a[i], b[k], a[k]]]
    return out


def indexed(facets):
    numbers, triangles = {}, []
    for f in facets:
        triangles.append([numbers.setdefault(v, len(numbers)) for v in f])
    return list(numbers), triangles


def gltf(roots, shapes):
    """The document without its buffer's place, and the buffer."""
    doc = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "accessors": [], "bufferViews": []}
    buffer = b""

    def view(data, component, kind, count):
        nonlocal buffer
        doc["accessors"].append({"bufferView": len(doc["bufferViews"]), "componentType": component, "type": kind, "count": count})
        doc["bufferViews"].append({"buffer": 0, "byteOffset": len(buffer), "byteLength": len(data)})
        buffer += data
        return len(doc["accessors"]) - 1

    for facets in shapes:
        vertices, triangles = indexed(facets)
        positions = view(b"".join(struct.pack("<3f", *v) for v in vertices), 5126, "VEC3", len(vertices))
        indices = view(b"".join(struct.pack("<3I", *t) for t in triangles), 5125, "SCALAR", 3 * len(triangles))
        doc["meshes"].append({"primitives": [{"attributes": {"POSITION": positions}, "indices": indices}]})

    def add(n):
        out = {"name": n["name"]}
        number = len(doc["nodes"])
        doc["nodes"].append(out)
        if "trs" in n:
            out["translation"], out["rotation"], out["scale"] = n["trs"]
        elif "matrix" in n:
            m = n["matrix"]
            out["matrix"] = [*m[0::4], 0, *m[1::4], 0, *m[2::4], 0, *m[3::4], 1]
        if "shape" in n:
            out["mesh"] = n["shape"]
        children = [add(c) for c in n.get("children", [])]
        if children:
            out["children"] = children
        return number

    doc["scenes"][0]["nodes"] = [add(n) for n in roots]
    doc["buffers"] = [{"byteLength": len(buffer)}]
    return doc, buffer


def glb(roots, shapes):
    doc, buffer = gltf(roots, shapes)
    text = json.dumps(doc).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(buffer), len(text), 0x4E4F534A) + text + struct.pack("<II", len(buffer), 0x4E4942) + buffer


def embedded_gltf(roots, shapes):
    doc, buffer = gltf(roots, shapes)
    doc["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    return json.dumps(doc)


def threemf(path, roots, shapes, unit):
    """Every node becomes an object of its own; a shape is an object without a name that those nodes use which have it alone."""
    objects, count = [], 0

    def text(m):
        return " ".join(repr(m[4 * (i % 3) + i // 3]) for i in range(12))

    def mesh(facets):
        vertices, triangles = indexed(facets)
        return ("<mesh><vertices>" + "".join(f'<vertex x="{v[0]!r}" y="{v[1]!r}" z="{v[2]!r}"/>' for v in vertices) + "</vertices><triangles>" +
                "".join(f'<triangle v1="{t[0]}" v2="{t[1]}" v3="{t[2]}"/>' for t in triangles) + "</triangles></mesh>")

    def add(n):
        nonlocal count
        inside = mesh(shapes[n["shape"]]) if "shape" in n else "<components>" + "".join(
            f'<component objectid="{add(c)}" transform="{text(matrix_of(c))}"/>' for c in n["children"]) + "</components>"
        count += 1
        objects.append(f'<object id="{count}" name="{n["name"]}">{inside}</object>')
        return count

    items = "".join(f'<item objectid="{add(n)}" transform="{text(matrix_of(n))}"/>' for n in roots)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as package:
        package.writestr("[Content_Types].xml", "<Types/>")
        package.writestr("_rels/.rels", '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r" Target="/3D/3dmodel.model" '
                         'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        package.writestr("3D/3dmodel.model", f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>' +
                         "".join(objects) + f"</resources><build>{items}</build></model>")


def octahedron():
    """Of 4 across, around (2, 2, 2)."""
    tips = [(0.0, 2.0, 2.0), (4.0, 2.0, 2.0), (2.0, 0.0, 2.0), (2.0, 4.0, 2.0), (2.0, 2.0, 0.0), (2.0, 2.0, 4.0)]
    facets = []
    for x in (0, 1):
        for y in (0, 1):
            for z in (0, 1):
                f = (tips[x], tips[2 + y], tips[4 + z])
                facets.append(f if (x + y + z) % 2 else (f[0], f[2], f[1]))
    return facets


def machine():
    """Instances, nesting, a mirrored and a scaled node, quaternions; names in several scripts, with what globs know as special."""
    bolt = {"shape": 1}
    group = [dict(bolt, name="bolt", trs=([1.5, 0, 4], [0, 0, 0, 1], [0.25, 0.25, 0.75])),
             dict(bolt, name="болт", trs=([4, 2, 5], [0.5, 0.1, -0.3, 0.7], [0.5, 0.5, 0.5])),
             {"name": "支持体", "matrix": [-1.0, 0, 0, 3, 0, 1, 0, 1, 0, 0, 2, 0], "children": [dict(bolt, name="a/b [1]*", trs=([0, 0, 0], [0, 0, 0.25, 1], [0.5, 0.5, 0.5]))]}]
    roots = [{"name": "plate", "shape": 0, "trs": ([0, 0, 0], [0, 0, 0, 1], [12, 8, 1])},
             {"name": "left", "children": group},
             {"name": "right", "matrix": [0.0, -1, 0, 12, 1, 0, 0, 3, 0, 0, 1, 0.5], "children": group}]
    return roots, [solids.box_facets((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), octahedron()]
