"""The geometry of a draw after the last stage before the rasterizer: positions, varyings and triangles."""
import numpy as np
import renderdoc as rd

import geometry

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
    aligned as in std430. The location of clip distances is None."""
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
            outputs.append((None, 0, offset, output.compCount))
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


def _instance(mesh, buffers, topology):
    """(rows of bytes, triangles) of one instance."""
    if mesh.vertexResourceId == _NULL or mesh.vertexByteStride == 0:
        raise LeftOut("RenderDoc has no vertices after the vertex shader: " + str(mesh.status).strip(),
                      geometry.primitives_of(topology, mesh.numIndices))
    restart = None
    if mesh.indexResourceId != _NULL:
        width = mesh.indexByteStride
        raw = buffers.whole(mesh.indexResourceId)
        indices = np.frombuffer(raw, f"<u{width}", mesh.numIndices, mesh.indexByteOffset).astype(np.int64)
        if mesh.allowRestart and topology != "TriangleList":
            restart = mesh.restartIndex & ((1 << 8 * width) - 1)
        live = indices != restart if restart is not None else slice(None)
        indices[live] += mesh.baseVertex
        if restart is not None:
            indices[~live] = restart = -1
    else:
        indices = np.arange(mesh.numIndices)
    triangles = geometry.triangles_of(topology, indices, restart)
    if triangles is None:
        reason = ("points" if topology.startswith("Point") else "lines" if topology.startswith("Line")
                  else f"topology {topology}")
        raise LeftOut(reason, geometry.primitives_of(topology, mesh.numIndices))
    raw = buffers.whole(mesh.vertexResourceId)
    room = max(0, (len(raw) - mesh.vertexByteOffset) // mesh.vertexByteStride)
    count = min(room, int(triangles.max()) + 1) if len(triangles) else 0
    triangles = triangles[((triangles >= 0) & (triangles < count)).all(1)]
    rows = np.frombuffer(raw, np.uint8, count * mesh.vertexByteStride, mesh.vertexByteOffset)
    return rows.reshape(count, mesh.vertexByteStride), triangles


def _varyings(inputs, outputs, column, count):
    """Bits (count x sum of components) of what the fragment shader reads, from outputs with the same locations and
    components; 0 where there is none."""
    at = {(location, first + k): offset + 4 * k for location, first, offset, components in outputs
          for k in range(components)}
    wanted = [(one["location"], one.get("component", 0) + k) for one in inputs for k in range(one["count"])]
    parts = [column(at[place], 1, "<u4") if place in at else np.zeros((count, 1), np.uint32) for place in wanted]
    return np.concatenate(parts, 1) if parts else np.zeros((count, 0), np.uint32)


def read_geometry(replay, command, z_from_0, inputs):
    """(clip positions n x 4 float32 with -w <= z <= w, bits of the fragment shader's `inputs` n x components uint32,
    triangles) of the current draw, all its instances together. Raises LeftOut."""
    controller = replay.controller
    reflection, stage = _last_stage(controller.GetPipelineState())
    if reflection is None:
        raise LeftOut("no vertex shader", 0)
    buffers, rows, triangles, base = _Buffers(controller), [], [], 0
    instances = max(1, command.numInstances) if command.flags & rd.ActionFlags.Instanced else 1
    for instance in range(instances):
        mesh = controller.GetPostVSData(instance, 0, stage)
        vertices, corners = _instance(mesh, buffers, mesh.topology.name)
        rows.append(vertices)
        triangles.append(corners + base)
        base += len(vertices)
    rows, triangles = np.concatenate(rows), np.concatenate(triangles)
    column = lambda offset, components, kind: np.ascontiguousarray(
        rows[:, offset: offset + 4 * components]).view(kind)
    outputs = [output for output in _layout(reflection.outputSignature) if output[2] + 4 * output[3] <= rows.shape[1]]
    clip = column(0, 4, "<f4")
    varyings = _varyings(inputs, outputs, column, len(rows))
    distances = [column(offset, count, "<f4") for location, _, offset, count in outputs if location is None]
    if distances and len(triangles):
        (clip, floats), triangles = geometry.clip_to_planes([clip, varyings.view("<f4")], triangles,
                                                            np.concatenate(distances, 1))
        varyings = floats.view("<u4")
    sound = np.isfinite(clip).all(1)
    triangles = triangles[sound[triangles].all(1)]
    if z_from_0:
        clip = clip.copy()
        clip[:, 2] = 2 * clip[:, 2] - clip[:, 3]
    return clip, varyings, triangles
