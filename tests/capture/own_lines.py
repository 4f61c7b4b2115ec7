"""A small program that draws with OpenGL ES 3 what is not triangles, `own_lines.py [SAMPLES]`, until it is ended: a star
of lines, wide ones, strips with restarts, points with coordinates; and it counts layers with a stencil of both faces and
clears depth and stencil between draws."""
import ctypes
import math
import struct
import sys

from own_program import (GL_COLOR_BUFFER_BIT, GL_DEPTH_BUFFER_BIT, GL_DEPTH_TEST, HEIGHT, WIDTH, library, make_program,
                         open_window, start_egl, take_vertices)

VERTEX_SHADER = b"""#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
out vec4 vertex_color;
void main() {
  float w = 1.0 + 0.5 * position.x;  // perspective
  gl_Position = vec4(position.xy * w, position.z, w);
  gl_PointSize = 4.0 + 6.0 * color.b;
  vertex_color = color;
}"""
FRAGMENT_SHADER = b"""#version 300 es
precision mediump float;
uniform bool is_point;
in vec4 vertex_color;
out vec4 color;
void main() { color = is_point ? vec4(gl_PointCoord, 0.5, 1.0) : vertex_color; }"""

EGL_STENCIL_SIZE, EGL_SAMPLES = 0x3026, 0x3031
GL_POINTS, GL_LINES, GL_LINE_LOOP, GL_LINE_STRIP, GL_TRIANGLES = 0, 1, 2, 3, 4
GL_STENCIL_BUFFER_BIT, GL_STENCIL_TEST, GL_PRIMITIVE_RESTART, GL_UNSIGNED_SHORT = 0x400, 0xB90, 0x8D69, 0x1403
GL_FRONT, GL_BACK, GL_FRONT_AND_BACK, GL_ALWAYS, GL_LESS = 0x404, 0x405, 0x408, 0x207, 0x201
GL_KEEP, GL_REPLACE, GL_INCREMENT_WRAP, GL_DECREMENT_WRAP = 0x1E00, 0x1E01, 0x8507, 0x8508
ELEMENTS = [0, 1, 2, 0xFFFF, 3, 4, 5, 6, 0xFFFF, 7]


def vertex(x, y, z, r, g, b):
    return struct.pack("<7f", x, y, z, r, g, b, 1)


def shapes():
    """Vertices by name."""
    star = [(0.3 + reach * math.cos(angle), reach * 1.2 * math.sin(angle))
            for angle in (k * math.pi / 13 for k in range(26)) for reach in (0.05, 0.6)]
    loop = [(-0.9, -0.9), (-0.2, -0.9), (-0.2, -0.35), (-0.9, -0.35)]
    strip = [(-0.95 + 0.11 * k, 0.9 - 0.25 * (k % 2)) for k in range(8)]
    points = [(-0.8 + 0.27 * k, 0.1 + 0.07 * k) for k in range(5)]
    front, back = [(-0.9, -0.8), (0.9, -0.8), (0, 0.9)], [(-0.9, 0.6), (0, -0.9), (0.9, 0.6)]
    back.reverse()
    whole = [(-1, -1), (3, -1), (-1, 3)]
    color = lambda k, z: (z, 0.2 + 0.15 * (k % 5), 0.9 - 0.2 * (k % 4), 0.1 * (k % 9))
    return {name: b"".join(vertex(x, y, *color(k, z)) for k, (x, y) in enumerate(places))
            for name, places, z in (("star", star, 0), ("loop", loop, 0.2), ("strip", strip, -0.1), ("points", points, 0.1),
                                    ("front", front, 0.1), ("back", back, 0.3), ("whole", whole, 0.5))}


def main(samples):
    show = start_egl(*open_window(), (EGL_STENCIL_SIZE, 8, EGL_SAMPLES, samples))
    gl = library("GLESv2")
    f = ctypes.c_float
    is_point = gl.glGetUniformLocation(make_program(gl, VERTEX_SHADER, FRAGMENT_SHADER), b"is_point")
    found = shapes()
    data, first, count, at = b"".join(found.values()), {}, {}, 0
    for name, vertices in found.items():
        first[name], count[name] = at, len(vertices) // 28
        at += count[name]
    elements = struct.pack(f"<{len(ELEMENTS)}H", *(e if e == 0xFFFF else e + first["strip"] for e in ELEMENTS))
    take_vertices(gl, data)
    draw = lambda kind, name: gl.glDrawArrays(kind, first[name], count[name])
    gl.glViewport(0, 0, WIDTH, HEIGHT)
    gl.glEnable(GL_PRIMITIVE_RESTART)
    gl.glEnable(GL_DEPTH_TEST)
    gl.glClearColor(f(0.1), f(0.15), f(0.3), f(1))
    while True:
        gl.glClearStencil(0)
        gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT)
        # Where a front face lies, 1; where a back face lies, 255; where both do, 0.
        gl.glEnable(GL_STENCIL_TEST)
        gl.glStencilFunc(GL_ALWAYS, 0, 255)
        gl.glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_INCREMENT_WRAP)
        gl.glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_DECREMENT_WRAP)
        gl.glColorMask(0, 0, 0, 0)
        gl.glDepthMask(0)
        draw(GL_TRIANGLES, "front")
        draw(GL_TRIANGLES, "back")
        gl.glColorMask(1, 1, 1, 1)
        gl.glDepthMask(1)
        gl.glStencilFunc(GL_LESS, 1, 255)
        gl.glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP)
        draw(GL_TRIANGLES, "whole")
        # Points only where the wide loop is not: its stencil is 4, that of all else 9.
        gl.glClearStencil(9)
        gl.glClear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT)
        gl.glStencilFunc(GL_ALWAYS, 4, 255)
        gl.glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE)
        gl.glLineWidth(f(3))
        draw(GL_LINE_LOOP, "loop")
        gl.glStencilFunc(GL_LESS, 4, 255)
        gl.glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP)
        gl.glUniform1i(is_point, 1)
        draw(GL_POINTS, "points")
        gl.glUniform1i(is_point, 0)
        gl.glDisable(GL_STENCIL_TEST)
        gl.glLineWidth(f(1))
        draw(GL_LINES, "star")
        gl.glDrawElements(GL_LINE_STRIP, len(ELEMENTS), GL_UNSIGNED_SHORT,
                          ctypes.create_string_buffer(elements, len(elements)))
        show()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 0)
