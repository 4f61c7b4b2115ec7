"""The geometry of a draw after the last stage before the rasterizer: positions, varyings and triangles, which lines and
points become."""
import numpy as np
import renderdoc as rd

import geometry
import wide
from programs import POINT_COORDINATES

_NULL = rd.ResourceId.Null()


class LeftOut(Exception):
    """Why a draw has no triangles; `primitives` of it are left out."""

    def __init__(self, reason, primitives):
        super().__init__(reason)
        self.reason, self.primitives = reason, primitives


def _last_stage(pipe):
    for stage in (rd.ShaderStage.Geometry, rd.ShaderStage.Tess_Eval):
        if pipe.GetShaderReflection(stage) is not None:
            return pipe.GetShaderReflection(stage), rd.MeshDataStage.GSOut
    return pipe.GetShaderReflection(rd.ShaderStage.Vertex), rd.MeshDataStage.VSOut


def _layout(signature):
    """(location, first component, offset, components) of the outputs after the position, as RenderDoc packs them:
    aligned as in std430. That of clip distances has the location "clip", and the size of points "size"."""
    offset, outputs = 16, []
    for output in signature:
        if output.systemValue == rd.ShaderBuiltin.Position:
            continue
        align = {1: 4, 2: 8}.get(output.compCount, 16)
        offset = (offset + align - 1) // align * align
        component = (output.regChannelMask & -output.regChannelMask).bit_length() - 1
        if output.systemValue == rd.ShaderBuiltin.Undefined:
            outputs.append((output.regIndex, max(0, component), offset, output.compCount))
        elif output.systemValue == rd.ShaderBuiltin.ClipDistance:
            outputs.append(("clip", 0, offset, output.compCount))
        elif output.systemValue == rd.ShaderBuiltin.PointSize:
            outputs.append(("size", 0, offset, 1))
        offset += 4 * output.compCount
    return outputs


class _Buffers:
    """Buffers as bytes, each fetched once per draw."""

    def __init__(self, controller):
        self.controller, self.kept = controller, {}

    def whole(self, buffer):
        if buffer not in self.kept:
            self.kept[buffer] = bytes(self.controller.GetBufferData(buffer, 0, 0))
        return self.kept[buffer]


def _restarts(controller, command):
    """Which of an indexed draw's indices begin a new strip. RenderDoc renumbers indices for what it returns, and those
    of 16 bits that begin a strip, too."""
    bound = controller.GetPipelineState().GetIBuffer()
    width = bound.byteStride
    data = bytes(controller.GetBufferData(bound.resourceId, bound.byteOffset + width * command.indexOffset,
                                          width * command.numIndices))
    return np.frombuffer(data, f"<u{width}") == (1 << 8 * width) - 1


def _instance(mesh, buffers, topology, restarts):
    """(rows of bytes, corners of primitives) of one instance. `restarts`: gives those of its draw."""
    if mesh.vertexResourceId == _NULL or mesh.vertexByteStride == 0:
        raise LeftOut("RenderDoc has no vertices after the vertex shader: " + str(mesh.status).strip(),
                      geometry.primitives_of(topology, mesh.numIndices))
    if mesh.indexResourceId != _NULL:
        width = mesh.indexByteStride
        raw = buffers.whole(mesh.indexResourceId)
        indices = np.frombuffer(raw, f"<u{width}", mesh.numIndices, mesh.indexByteOffset).astype(np.int64)
        indices += mesh.baseVertex
        if mesh.allowRestart and not topology.endswith("List"):
            found = restarts()
            indices[: len(found)][found[: len(indices)]] = -1
    else:
        indices = np.arange(mesh.numIndices)
    corners = geometry.corners_of(topology, indices, -1)
    if corners is None:
        raise LeftOut(f"topology {topology}", geometry.primitives_of(topology, mesh.numIndices))
    raw = buffers.whole(mesh.vertexResourceId)
    room = max(0, (len(raw) - mesh.vertexByteOffset) // mesh.vertexByteStride)
    count = min(room, int(corners.max()) + 1) if len(corners) else 0
    corners = corners[((corners >= 0) & (corners < count)).all(1)]
    rows = np.frombuffer(raw, np.uint8, count * mesh.vertexByteStride, mesh.vertexByteOffset)
    return rows.reshape(count, mesh.vertexByteStride), corners


def _varyings(inputs, outputs, column, count):
    """Bits (count x sum of components) of what the fragment shader reads, from outputs with the same locations and
    components; 0 where there is none."""
    at = {(location, first + k): offset + 4 * k for location, first, offset, components in outputs
          for k in range(components)}
    wanted = [(one["location"], one.get("component", 0) + k) for one in inputs for k in range(one["count"])]
    parts = [column(at[place], 1, "<u4") if place in at else np.zeros((count, 1), np.uint32) for place in wanted]
    return np.concatenate(parts, 1) if parts else np.zeros((count, 0), np.uint32)


def _cut_triangles(clip, varyings, triangles, distances, api, count):
    if api["cull"] == "FrontAndBack":
        raise LeftOut("both faces are culled", 0)
    if api["fill"] != "Solid":
        raise LeftOut("triangles drawn as lines or points", count)
    if distances.shape[1] and count:
        (clip, floats), triangles = geometry.clip_to_planes([clip, varyings.view("<f4")], triangles, distances)
        varyings = floats.view("<u4")
    return clip, varyings, triangles


def _widen(clip, varyings, corners, distances, sizes, api, inputs, samples):
    """Lines and points as triangles, which face the viewer and of which none is culled."""
    is_line = corners.shape[1] == 2
    if is_line and api["line_mode"] == "RectangularSmooth":
        raise LeftOut("smooth lines", len(corners))
    if is_line and api["has_stipple"]:
        raise LeftOut("lines with a pattern", len(corners))
    api.update(cull="NoCull", bias=0, slope_bias=0)
    window = wide.Window(api["viewport"])
    distances = np.concatenate([wide.planes_of(clip, api["z_from_0"], not api["depth_clamp"]), distances], 1)
    if is_line:
        mixes = [not one.get("integer") and one.get("interpolation") != "flat" for one in inputs
                 for _ in range(one["count"])]
        ends = wide.Ends(clip, varyings, corners, mixes)
        ends.cut(distances[corners.T])
        return wide.lines_as_triangles(ends, window, api["line_width"], api["line_mode"] != "Bresenham", samples > 1,
                                       api["front_ccw"])
    seen = corners[:, 0][(distances[corners[:, 0]] >= 0).all(1)]
    clip, varyings, triangles, coordinates = wide.points_as_triangles(clip[seen], varyings[seen], sizes[seen], window,
                                                                      api["front_ccw"])
    place = 0
    for one in inputs:
        if one["location"] == POINT_COORDINATES:
            varyings[:, place: place + 2] = coordinates.view("<u4")
        place += one["count"]
    return clip, varyings, triangles


def read_geometry(replay, command, api, inputs, samples):
    """(clip positions n x 4 float32 with -w <= z <= w, bits of the fragment shader's `inputs` n x components uint32,
    triangles) of the current draw, all its instances together. `api`: as api_state.py has read it; of lines and points
    it is changed to that of their triangles. Raises LeftOut."""
    controller = replay.controller
    reflection, stage = _last_stage(controller.GetPipelineState())
    if reflection is None:
        raise LeftOut("no vertex shader", 0)
    buffers, rows, corners, base = _Buffers(controller), [], [], 0
    instances = max(1, command.numInstances) if command.flags & rd.ActionFlags.Instanced else 1
    for instance in range(instances):
        mesh = controller.GetPostVSData(instance, 0, stage)
        vertices, found = _instance(mesh, buffers, mesh.topology.name, lambda: _restarts(controller, command))
        rows.append(vertices)
        corners.append(found + base)
        base += len(vertices)
    rows, corners = np.concatenate(rows), np.concatenate(corners)
    column = lambda offset, components, kind: np.ascontiguousarray(
        rows[:, offset: offset + 4 * components]).view(kind)
    outputs = [output for output in _layout(reflection.outputSignature) if output[2] + 4 * output[3] <= rows.shape[1]]
    clip = column(0, 4, "<f4")
    varyings = _varyings(inputs, outputs, column, len(rows))
    named = lambda name: [column(offset, count, "<f4") for location, _, offset, count in outputs if location == name]
    distances = np.concatenate([np.zeros((len(rows), 0), np.float32), *named("clip")], 1)
    corners = corners[np.isfinite(clip).all(1)[corners].all(1)]
    if corners.shape[1] == 3:
        clip, varyings, triangles = _cut_triangles(clip, varyings, corners, distances, api, len(corners))
    else:
        sizes = named("size")[0][:, 0] if named("size") else np.ones(len(rows))
        clip, varyings, triangles = _widen(clip, varyings, corners, distances, sizes, api, inputs, samples)
    if api["z_from_0"]:
        clip = clip.copy()
        clip[:, 2] = 2 * clip[:, 2] - clip[:, 3]
    return np.float32(clip), varyings, triangles
