"""Hostile STEP files: what a reader must refuse, or survive, in bounded time and memory.

hostile_files(folder) writes them and returns a list of (path, what it is). The harmless file that they are made from is
Model().product("cube", cube) below: `Model` is also the way to write a small STEP file by hand.
"""

import itertools
import os
import random
import re

HEADER = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','2024-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""
END = "ENDSEC;\nEND-ISO-10303-21;\n"
MILLIMETRES = "(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))"


class Model:
    """The entities of one file. Methods add some and return the reference of the last, "#n"."""

    def __init__(self, length_unit=MILLIMETRES, units=True):
        self.lines = []
        self.application = self.add("APPLICATION_CONTEXT('')")
        self.product_context = self.add(f"PRODUCT_CONTEXT('',{self.application},'mechanical')")
        self.design_context = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{self.application},'design')")
        context = "GEOMETRIC_REPRESENTATION_CONTEXT(3)"
        if units:
            length = self.add(length_unit)
            angle = self.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
            solid_angle = self.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
            uncertainty = self.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'distance_accuracy_value','')")
            context += f" GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty})) GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))"
        self.context = self.add(f"({context} REPRESENTATION_CONTEXT('',''))")
        self.origin = self.axes((0, 0, 0))
        self.representation = {}

    def add(self, entity):
        self.lines.append(f"#{len(self.lines) + 1}={entity};\n")
        return f"#{len(self.lines)}"

    def next(self):
        return f"#{len(self.lines) + 1}"

    def text(self):
        return HEADER + "".join(self.lines) + END

    def point(self, p):
        return self.add(f"CARTESIAN_POINT('',({','.join(number(x) for x in p)}))")

    def direction(self, d):
        return self.add(f"DIRECTION('',({','.join(number(x) for x in d)}))")

    def axes(self, origin, axis=(0, 0, 1), reference=(1, 0, 0)):
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(origin)},{self.direction(axis)},{self.direction(reference)})")

    def product(self, name, solid=None, identifier=None):
        """A product whose shape is what `solid` adds to the model, or an assembly. Returns its definition."""
        product = self.add(f"PRODUCT('{name if identifier is None else identifier}','{name}','''',({self.product_context}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{formation},{self.design_context})")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        items = self.origin if solid is None else f"{self.origin},{solid(self)}"
        kind = "SHAPE_REPRESENTATION" if solid is None else "ADVANCED_BREP_SHAPE_REPRESENTATION"
        self.representation[definition] = self.add(f"{kind}('',({items}),{self.context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{self.representation[definition]})")
        return definition

    def place(self, assembly, part, axes=None, name="", identifier="", description=""):
        """An occurrence of `part` in `assembly`, both product definitions."""
        transformation = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',{self.origin},{axes or self.origin})")
        relation = self.add(
            f"(REPRESENTATION_RELATIONSHIP('','',{self.representation[part]},{self.representation[assembly]})"
            f" REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({transformation}) SHAPE_REPRESENTATION_RELATIONSHIP())")
        use = self.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{identifier}','{name}','{description}',{assembly},{part},$)")
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{use})")
        return self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{shape})")


def number(x):
    return x if isinstance(x, str) else repr(float(x)).upper()


def plane(model, corner, axis, reference):
    return model.add(f"PLANE('',{model.axes(corner, axis, reference)})")


def cube(model, size=1, line_offset=0, surface=plane, bounds=True, repeat=1):
    """A cube from 0 to `size`. The parameters are ways to spoil it."""
    corners = list(itertools.product((0, 1), repeat=3))
    at = {c: [size * x if not isinstance(size, str) else (size if x else 0) for x in c] for c in corners}
    vertex = {c: model.add(f"VERTEX_POINT('',{model.point(at[c])})") for c in corners}
    edge = {}
    for a, b in itertools.combinations(corners, 2):
        step = [y - x for x, y in zip(a, b)]
        if sorted(step) == [0, 0, 1]:
            start = [x + line_offset for x in at[a]] if line_offset else at[a]
            line = model.add(f"LINE('',{model.point(start)},{model.add(f'''VECTOR('',{model.direction(step)},1.)''')})")
            edge[a, b] = model.add(f"EDGE_CURVE('',{vertex[a]},{vertex[b]},{line},.T.)")
    faces = []
    for axis in range(3):
        for side in (0, 1):
            unit = [[float(i == k) for i in range(3)] for k in range(3)]
            loop = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)) if side else ((0, 0), (0, 1), (1, 1), (1, 0)):
                corner = [0, 0, 0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, u, v
                loop.append(tuple(corner))
            oriented = [
                model.add(f"ORIENTED_EDGE('',*,*,{edge[min(a, b), max(a, b)]},{'.T.' if a < b else '.F.'})")
                for a, b in zip(loop, loop[1:] + loop[:1])]
            bound = model.add(f"FACE_OUTER_BOUND('',{model.add(f'''EDGE_LOOP('',({','.join(oriented)}))''')},.T.)") if bounds else ""
            normal = [x if side else -x for x in unit[axis]]
            faces.append(model.add(f"ADVANCED_FACE('',({bound}),{surface(model, at[loop[0]], normal, unit[(axis + 1) % 3])},.T.)"))
    return solid_of(model, faces * repeat)


def solid_of(model, faces):
    return model.add(f"MANIFOLD_SOLID_BREP('',{model.add(f'''CLOSED_SHELL('',({','.join(faces)}))''')})")


def closed_surface(model, surface):
    """A solid of one face without edges, on a sphere or a torus."""
    loop = model.add(f"VERTEX_LOOP('',{model.add(f'''VERTEX_POINT('',{model.point((0, 0, 0))})''')})")
    return solid_of(model, [model.add(f"ADVANCED_FACE('',({model.add(f'''FACE_BOUND('',{loop},.T.)''')}),{surface},.T.)")])


def sphere(radius, centre=(0, 0, 0)):
    return lambda model: closed_surface(model, model.add(f"SPHERICAL_SURFACE('',{model.axes(centre)},{number(radius)})"))


def torus(major, minor):
    return lambda model: closed_surface(model, model.add(f"TOROIDAL_SURFACE('',{model.origin},{number(major)},{number(minor)})"))


def bspline(degree, multiplicity, knots="0.,1."):
    def surface(model, corner, normal, reference):
        points = ",".join("(" + ",".join(model.point((u, v, 0)) for v in range(2)) + ")" for u in range(2))
        many = f"({multiplicity},{multiplicity})"
        parameters = f"{many},{many},({knots}),({knots}),.UNSPECIFIED."
        return model.add(f"B_SPLINE_SURFACE_WITH_KNOTS('',{degree},{degree},({points}),.UNSPECIFIED.,.F.,.F.,.F.,{parameters})")
    return surface


def offset_of_itself(model, *_):
    return model.add(f"OFFSET_SURFACE('',{model.next()},1.,.F.)")


def of(solid, **options):
    model = Model(**options)
    model.product("hostile", solid)
    return model.text()


def spoiled(**options):
    return of(lambda model: cube(model, **options))


def assembly(levels, copies, cycle=False):
    """A chain of products, each of which holds the next `copies` times. A cycle closes it."""
    model = Model()
    parts = [model.product(f"level {i}") for i in range(levels)] + ([] if cycle else [model.product("cube", cube)])
    for i, part in enumerate(parts):
        if i + 1 < len(parts) or cycle:
            for _ in range(copies):
                model.place(part, parts[(i + 1) % len(parts)])
    return model


def cyclic_beside_cube():
    model = assembly(2, 1, cycle=True)
    model.product("cube", cube)
    return model.text()


def mapped(target=None):
    """A cube's representation as a mapped item of another, or of itself. `target`: scale and third axis of its transformation."""
    model = Model()
    definition = model.product("cube", cube)
    source = whole = model.representation[definition]
    where = model.origin
    if target:
        whole = model.representation[model.product("mapped")]
        first, second, third = (model.direction(d) for d in ((1, 0, 0), (0, 1, 0), (0, 0, target[1])))
        origin = model.point((0, 0, 0))
        where = model.add(f"CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',{first},{second},{origin},{number(target[0])},{third})")
    item = model.add(f"MAPPED_ITEM('',{model.add(f'''REPRESENTATION_MAP({model.origin},{source})''')},{where})")
    return re.sub(f"{whole}=[A-Z_]*\\('',\\(", f"{whole}=SHAPE_REPRESENTATION('',({item},", model.text())


def big_and_small():
    model = Model()
    root = model.product("root")
    for name, radius, centre in (("big", 1e6, (0, 0, 0)), ("small", 1e-3, (2e6, 0, 0))):
        model.place(root, model.product(name, sphere(radius, centre)))
    return model.text()


def inch(factor):
    """A cube in a unit of length that is `factor` millimetres, or for None a multiple of itself."""
    def of_unit(reference):
        return f"(CONVERSION_BASED_UNIT('INCH',{reference}) LENGTH_UNIT() NAMED_UNIT($))"
    # The unit is the fourth entity of a model. What it refers to comes behind all others.
    text = of(cube, length_unit=of_unit("#900001"))
    inner = "#4" if factor is None else "#900002"
    measure = f"#900001=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({number(factor or 25.4)}),{inner});\n#900002={MILLIMETRES};\n"
    return text.replace(END, measure + END)


def without_end(text):
    return text[:-len(END)]


def hostile_texts():
    """Yields (name, text or bytes, what it is)."""
    good = of(cube)
    data = good.index("DATA;\n") + len("DATA;\n")
    yield "no_bytes", "", "a file of no bytes"
    yield "first_line_only", "ISO-10303-21;\n" + "This is a letter, not a STEP file.\n" * 50, "not a STEP file after the first line"
    yield "empty_data", HEADER + END, "a DATA section without entities"
    yield "no_data", HEADER.replace("DATA;\n", "") + "END-ISO-10303-21;\n", "a header alone"
    yield "garbage", HEADER.encode() + random.Random(1).randbytes(100000), "binary garbage after the header"
    yield "nul_bytes", good.encode()[:data + 500] + bytes(1000) + good.encode()[data + 500:], "1000 zero bytes amid the entities"
    middle = good.index("EDGE_CURVE", len(good) // 3)
    for name, end, what in (
            ("header", 60, "in its header"), ("data", data, "behind DATA;"), ("keyword", middle + 4, "within a keyword"),
            ("string", middle + len("EDGE_CURVE('"), "within a string"), ("reference", good.index("#", middle) + 1, "within a reference"),
            ("solid", good.index("MANIFOLD_SOLID_BREP"), "before its solid"), ("end", len(good) - len(END), "before ENDSEC"),
            ("last_line", len(good) - 5, "in its last line")):
        yield "cut_" + name, good[:end], "a cube's file cut " + what
    yield "open_string", good.replace("CLOSED_SHELL(''", "CLOSED_SHELL('"), "a string that doesn't end"
    yield "open_comment", good.replace("DATA;\n", "DATA;\n/* "), "a comment that doesn't end"
    escapes = r"'\X2\04\X0\ \X2\D83D \X4\FFFFFFFF\X0\ \X\ZZ \S\ \P \\X2\0043'"
    yield "broken_escapes", good.replace("'hostile'", escapes), "names with broken escapes"
    yield "long_name", good.replace("'hostile'", "'" + "name " * 800000 + "'"), "names of 4 MB"
    yield "parentheses", without_end(good) + "#900000=GROUP(" + "(" * 100000 + ")" * 100000 + ");\n" + END, "100,000 nested parentheses"
    yield "same_number", good.replace("#30=", "#29="), "two entities of one number"
    yield "huge_number", good.replace("#30=", "#99999999999999999999="), "an entity whose number has 20 digits"

    yield "missing_entities", good.replace("VERTEX_POINT('',#", "VERTEX_POINT('',#99"), "references to entities that don't exist"
    yield "wrong_types", re.sub("FACE_OUTER_BOUND\\(''.*;", "FACE_OUTER_BOUND('',#1,.T.);", good), "loops that are something else"
    yield "wrong_parameters", good.replace("LINE('',#", "LINE(1.,'',.T.,(#1,#2),$,#"), "lines with parameters of wrong types and number"
    yield "self_solid", of(lambda model: model.add(f"MANIFOLD_SOLID_BREP('',{model.next()})")), "a solid that is its own shell"
    yield "self_surface", spoiled(surface=offset_of_itself), "surfaces that are offset from themselves"
    trimmed = re.sub(r"(#\d+)=LINE\(.*\);", r"\1=TRIMMED_CURVE('',\1,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);", good)
    yield "self_curve", trimmed, "curves that are cut from themselves"
    yield "self_unit", inch(None), "a unit that is a multiple of itself"
    yield "mapped_cycle", mapped(), "a representation that holds itself as a mapped item"
    yield "contains_itself", assembly(1, 1, cycle=True).text(), "a product that contains itself"
    yield "cyclic", cyclic_beside_cube(), "two products that contain each other, and a cube beside them"
    yield "many_occurrences", assembly(40, 2).text(), "a cube that occurs 2^40 times, in 40 levels"
    yield "deep", assembly(1000, 1).text(), "a cube in 1000 levels of assemblies"

    yield "no_unit", of(cube, units=False), "a cube in no unit"
    yield "zero_unit", inch(1e-300), "a cube in units of 1e-300 mm"
    yield "huge_unit", inch(1e300), "a cube in units of 1e300 mm"
    yield "zero_scale", mapped((0, 1)), "a cube scaled by 0"
    yield "double_scale", mapped((2, 1)), "a cube scaled by 2"
    yield "negative_scale", mapped((-2, 1)), "a cube scaled by -2"
    yield "left_handed", mapped((1, -1)), "a cube that is mirrored by its placement"
    yield "not_a_number", spoiled(size="NAN"), "coordinates NAN"
    yield "infinite", spoiled(size="1.E999"), "coordinates 1.E999"
    yield "greatest", spoiled(size=1e308), "a cube of size 1e308"
    yield "far", spoiled(size=1e15), "a cube of size 1e15"
    yield "tiny", spoiled(size=1e-12), "a cube of size 1e-12"
    yield "zero_axis", good.replace("DIRECTION('',(0.0,0.0,1.0))", "DIRECTION('',(0.0,0.0,0.0))"), "axes of length zero"
    yield "parallel_axes", good.replace("DIRECTION('',(1.0,0.0,0.0))", "DIRECTION('',(0.0,0.0,1.0))"), "axes that are parallel to their reference"
    for name, radius in (("zero", 0), ("negative", -1), ("huge", 1e300)):
        yield name + "_radius", of(sphere(radius)), f"a sphere of radius {radius}"
    yield "spindle", of(torus(1, 5)), "a torus that cuts itself"
    yield "flat_torus", of(torus(5, 0)), "a torus whose minor radius is 0"
    yield "huge_degree", spoiled(surface=bspline(10**9, 10**9 + 1)), "B-spline surfaces of degree 10^9"
    yield "many_knots", spoiled(surface=bspline(1, 2**31 - 1)), "B-spline surfaces with knots of multiplicity 2^31 - 1"
    yield "falling_knots", spoiled(surface=bspline(1, 2, "1.,0.")), "B-spline surfaces whose knots fall"
    yield "no_bounds", spoiled(bounds=False), "planar faces without bounds"
    yield "no_faces", of(lambda model: solid_of(model, [])), "a shell without faces"
    yield "missed_vertices", spoiled(line_offset=5), "edges that miss their vertices"
    yield "same_faces", spoiled(repeat=17000), "a shell that lists its six faces 17,000 times"
    yield "big_and_small", big_and_small(), "a sphere of radius 1e6 beside one of radius 1e-3"


def hostile_files(folder):
    files = []
    for name, text, what in hostile_texts():
        path = os.path.join(folder, name + ".step")
        with open(path, "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        files.append((path, what))
    return files
