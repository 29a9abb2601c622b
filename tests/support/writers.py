"""Files as other programs write them: one line or a few for each way, of points and polygons. Each returns bytes."""

import base64
import struct
import zlib

import numpy as np


def lines(head, rows, between=" "):
    return ("\n".join([*head, *(between.join(map(str, row)) for row in rows)]) + "\n").encode()


def vertices(points, after=()):
    return [("v", *(f"{value:.9g}" for value in point), *after) for point in points]


def obj(p):
    return lines([], vertices(p.points) + [("f", *(i + 1 for i in face)) for face in p.faces])


def obj_maya(p):
    """Texture and normal indices of their own counts, groups, materials, smoothing, a byte-order mark, CRLF."""
    head = ["mtllib ../http://x/a.mtl", "g default", "# Übergröße"]
    rest = [
        ("vt", 0.1, 0.2),
        ("vn", 0, 0, 1),
        ("vn", 0, 1, 0),
        ("s", "off"),
        ("g", "pCylinder1"),
        ("usemtl", "initialShadingGroup"),
    ]
    faces = [("f", *(f"{i + 1}/1/{1 + i % 2}" for i in face)) for face in p.faces]
    text = lines(head, vertices(p.points) + rest + faces).decode()
    return b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode("latin-1")


def obj_meshlab(p):
    """A normal before each vertex, colours behind it, texture indices left out."""
    rows = [row for v in vertices(p.points, (0.5, 0.25, 1)) for row in (("vn", 0, 0, 1), v)]
    return lines(["####"], rows + [("f", *(f"{i + 1}//{i + 1}" for i in face), "# face") for face in p.faces])


def obj_negative(p):
    """Vertices counted from the last one, each face right behind those of its own."""
    rows = []
    for face in p.faces:
        rows += [*vertices(p.points[face]), ("f", *range(-len(face), 0))]
    return lines(["o Tube"], rows)


def obj_continued(p):
    """Lines that go on, edges, points, weights, tabulators."""
    rows = (
        vertices(p.points, (1.0,))
        + [("l", 1, 2), ("p", 3)]
        + [("f", *(f"{i + 1} \\\n" for i in face[:-1]), face[-1] + 1) for face in p.faces]
    )
    return lines([], rows, "\t")


def ply(
    p,
    order="ascii",
    real="float",
    index="int",
    size="uchar",
    name="vertex_indices",
    normals=False,
    colours=False,
    edges=False,
):
    """Any PLY: normals come before the coordinates, colours after the corners, edges before the faces."""
    mark = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[order]
    types = {"float": "f4", "double": "f8", "float32": "f4", "float64": "f8", "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2",
             "int": "i4", "uint": "u4", "int64": "i8", "uint64": "u8", "uint8": "u1", "int32": "i4"}  # fmt: skip
    coordinates = [f"property {real} {n}" for n in "xyz"]
    head = ["ply", f"format {order} 1.0", "comment Übung"]
    head += [
        f"element vertex {len(p.points)}",
        *(["property float nx", "property float ny", "property float nz"] if normals else []),
        *coordinates,
    ]
    head += ["element edge 2", "property int vertex1", "property int vertex2"] if edges else []
    head += [f"element face {len(p.faces)}", f"property list {size} {index} {name}"]
    head += ["property uchar red", "property list uchar float texcoord"] if colours else []
    head = ("\n".join([*head, "comment last", "end_header"]) + "\n").encode("latin-1")
    normal = np.zeros((len(p.points), 3 if normals else 0))
    if not mark:
        rows = [(*n, *(f"{v:.9g}" for v in point)) for n, point in zip(normal, p.points, strict=True)]
        rows += [(0, 1), (1, 2)] if edges else []
        rows += [(len(face), *face, *((7, 2, 0.5, 0.5) if colours else ())) for face in p.faces]
        return head + lines([], rows) + b"comment the end\n"
    body = np.rec.fromarrays(
        [*normal.astype(mark + "f4").T, *p.points.astype(mark + types[real]).T],
        names=[f"c{i}" for i in range(3 + normal.shape[1])],
    ).tobytes()
    body += np.array([0, 1, 1, 2], mark + "i4").tobytes() if edges else b""
    for face in p.faces:
        body += np.array([len(face)], mark + types[size]).tobytes() + np.array(face, mark + types[index]).tobytes()
        body += b"\x07\x02" + np.array([0.5, 0.5], mark + "f4").tobytes() if colours else b""
    return head + body


def corners(p):
    return np.array([p.points[face] for face in p.faces])


def stl(p):
    facets = np.zeros(len(p.faces), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    facets["v"] = corners(p)
    return (
        b"solid made by a program that begins like text".ljust(80) + struct.pack("<I", len(facets)) + facets.tobytes()
    )


def stl_text(p):
    rows = []
    for triangle in corners(p):
        rows += [
            "facet normal 0 0 0",
            "outer loop",
            *(f"vertex {x:.9e} {y:.9e} {z:.9e}" for x, y, z in triangle),
            "endloop",
            "endfacet",
        ]
    half = 7 * (len(p.faces) // 2)
    return "\n".join(["solid a", *rows[:half], "endsolid a", "solid b", *rows[half:], "endsolid b", ""]).encode()


def off(p, kind="OFF", apart=True):
    after = {"OFF": (), "COFF": (255, 0, 0, 255), "NOFF": (0, 0, 1)}[kind]
    counts = f"{len(p.points)} {len(p.faces)} 0"
    head = [kind, "# by hand", counts, ""] if apart else [f"{kind} {counts}"]
    faces = [(len(face), *face, *((0.5, 0.5, 0.5) if kind == "COFF" else ())) for face in p.faces]
    return lines(head, [(*(f"{v:.9g}" for v in point), *after) for point in p.points] + faces)


def vtk(p, binary=False, grid=False, version="3.0"):
    """A legacy file; from version 5.1 on with offsets."""
    n = sum(map(len, p.faces))
    flat = [i for face in p.faces for i in face]
    name = "CELLS" if grid else "POLYGONS"
    parts = [
        f"# vtk DataFile Version {version}",
        "a tube",
        "BINARY" if binary else "ASCII",
        f"DATASET {'UNSTRUCTURED_GRID' if grid else 'POLYDATA'}",
    ]

    def block(head, values, kind):
        body = np.asarray(values).astype(kind).tobytes() if binary else " ".join(f"{v:.9g}" for v in values).encode()
        return head.encode() + b"\n" + body + b"\n"

    text = "\n".join(parts).encode() + b"\n" + block(f"POINTS {len(p.points)} double", p.points.ravel(), ">f8")
    if version == "5.1":
        offsets = np.cumsum([0] + [len(face) for face in p.faces])
        text += block(f"{name} {len(offsets)} {n}\nOFFSETS vtktypeint64", offsets, ">i8") + block(
            "CONNECTIVITY vtktypeint64", flat, ">i8"
        )
    else:
        text += block(
            f"{name} {len(p.faces)} {n + len(p.faces)}", [i for face in p.faces for i in (len(face), *face)], ">i4"
        )
    if grid:
        text += block(f"CELL_TYPES {len(p.faces)}", [{3: 5, 4: 9}.get(len(face), 7) for face in p.faces], ">i4")
    return text + f"POINT_DATA {len(p.points)}\nSCALARS a float\nLOOKUP_TABLE default\n".encode()


def vtu(p, form="ascii", version="2.2", header="UInt64", pieces=1, kind="vtu"):
    """XML: text, base64, compressed, or appended; whole, or in pieces with points of their own."""
    width = {"UInt32": "<u4", "UInt64": "<u8"}[header]
    appended = b""

    def array(name, values, type_, components=1):
        nonlocal appended
        values = np.asarray(values).astype({"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}[type_])
        tag = f'<DataArray type="{type_}" Name="{name}" NumberOfComponents="{components}"'
        data = values.tobytes()
        if form == "ascii":
            return f'{tag} format="ascii">{" ".join(f"{v:.9g}" for v in values.ravel())}</DataArray>'
        if form == "appended":
            at, appended = len(appended), appended + np.array([len(data)], width).tobytes() + data
            return f'{tag} format="appended" offset="{at}"/>'
        if form == "compressed":
            blocks = [data[i : i + 500] for i in range(0, len(data), 500)]
            packed = [zlib.compress(block) for block in blocks]
            head = [len(blocks), 500, len(data) % 500, *map(len, packed)]
            return f'{tag} format="binary">\n{(base64.b64encode(np.array(head, width).tobytes()) + base64.b64encode(b"".join(packed))).decode()}\n</DataArray>'
        return f'{tag} format="binary">{base64.b64encode(np.array([len(data)], width).tobytes() + data).decode()}</DataArray>'

    text = ""
    grid, cells = {"vtu": ("UnstructuredGrid", "Cells"), "vtp": ("PolyData", "Polys")}[kind]
    for faces in (p.faces[i::pieces] for i in range(pieces)):
        used = sorted({i for face in faces for i in face})
        number = {old: new for new, old in enumerate(used)}
        text += f'<Piece NumberOfPoints="{len(used)}" NumberOf{cells}="{len(faces)}"><PointData/><Points>'
        text += array("Points", p.points[used], "Float64", 3) + f"</Points><{cells}>"
        text += array("connectivity", [number[i] for face in faces for i in face], "Int32")
        text += array("offsets", np.cumsum([len(face) for face in faces]), "Int64")
        text += array("types", [{3: 5, 4: 9}.get(len(face), 7) for face in faces], "UInt8") if kind == "vtu" else ""
        text += f"</{cells}></Piece>"
    compressor = ' compressor="vtkZLibDataCompressor"' if form == "compressed" else ""
    whole = f'<?xml version="1.0"?>\n<VTKFile type="{grid}" version="{version}" byte_order="LittleEndian" header_type="{header}"{compressor}><{grid}>{text}</{grid}>'
    end = b'<AppendedData encoding="raw">\n_' + appended + b"\n</AppendedData>" if form == "appended" else b""
    return whole.encode() + end + b"</VTKFile>\n"


def msh(p, version="2.2"):
    """Triangles and quads; numbers of the nodes have gaps."""
    tag = [3 * i + 5 for i in range(len(p.points))]
    head = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", "$Nodes"]
    if version == "2.2":
        nodes = [(len(tag),), *((t, *point) for t, point in zip(tag, p.points, strict=True))]
        cells = [(len(p.faces) + 1,), (1, 15, 2, 0, 1, tag[0])]
        cells += [(i + 2, {3: 2, 4: 3}[len(face)], 2, 1, 1, *(tag[j] for j in face)) for i, face in enumerate(p.faces)]
    else:
        nodes = [
            (1, len(tag), tag[0], tag[-1]),
            (2, 1, 0, len(tag)),
            *((t,) for t in tag),
            *(tuple(point) for point in p.points),
        ]
        blocks = [(k, [face for face in p.faces if len(face) == k + 1]) for k in (2, 3)]
        blocks = [(k, faces) for k, faces in blocks if faces]
        cells, number = [(len(blocks), len(p.faces), 1, len(p.faces))], 1
        for k, faces in blocks:
            cells.append((2, 1, k, len(faces)))
            for face in faces:
                cells.append((number, *(tag[j] for j in face)))
                number += 1
    return lines(head, nodes) + lines(["$EndNodes", "$Elements"], cells) + b"$EndElements\n"


def way(function, **options):
    return lambda p: function(p, **options)


POLYGONS = {
    "plain.obj": obj, "maya.obj": obj_maya, "meshlab.obj": obj_meshlab, "negative.obj": obj_negative,
    "continued.obj": obj_continued, "plain.ply": ply, "index.ply": way(ply, name="vertex_index", real="double"),
    "normals.ply": way(ply, normals=True, colours=True, edges=True),
    "colours.ply": way(ply, order="binary_little_endian", normals=True, colours=True, edges=True),
    "little_64.ply": way(ply, order="binary_little_endian", real="float64", index="int64"),
    "big_16.ply": way(ply, order="binary_big_endian", real="double", index="ushort", size="int"),
    "big_u64.ply": way(ply, order="binary_big_endian", index="uint64", size="uint"),
    "plain.off": off, "one_line.OFF": way(off, apart=False), "coloured.off": way(off, kind="COFF"), "normals.noff": way(off, kind="NOFF"),
    "text.vtk": vtk, "binary.vtk": way(vtk, binary=True), "grid.vtk": way(vtk, grid=True, binary=True),
    "text_5.vtk": way(vtk, version="5.1", grid=True), "binary_5.vtk": way(vtk, version="5.1", binary=True),
    "text.vtu": vtu, "old.vtu": way(vtu, version="0.1", header="UInt32", form="binary"),
    "compressed.vtu": way(vtu, form="compressed", version="1.0"), "appended.vtu": way(vtu, form="appended"),
    "pieces.vtu": way(vtu, form="binary", pieces=3), "text.vtp": way(vtu, kind="vtp"),
    "appended.vtp": way(vtu, kind="vtp", form="appended", pieces=2),
}  # fmt: skip
"""Ways to write polygons of any length."""

QUADS = {"two.msh": msh, "four.msh": way(msh, version="4.1")}
"""Ways to write triangles and quads."""

TRIANGLES = {"binary.stl": stl, "text.stl": stl_text}
"""Ways to write triangles, each with vertices of its own."""
