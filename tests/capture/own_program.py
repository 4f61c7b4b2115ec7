"""A small program that draws with OpenGL ES 3 into a window of 96 x 72 pixels, until it is ended: a floor, a decal on
it with a depth bias, six instanced quads, a quad that a scissor cuts, and a head-up display without depth test.

`beampipe capture --frame 10 -o captured_quads.json -- python3 tests/capture/own_program.py` made
traces/samples/captured_quads.json."""
import ctypes
import ctypes.util
import struct
import sys

WIDTH, HEIGHT = 96, 72

VERTEX_SHADER = b"""#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
uniform vec3 step;   // from one instance to the next
uniform bool flat_;  // positions are those of the picture
out vec4 vertex_color;
void main() {
  vec3 p = position + step * float(gl_InstanceID);
  const float near = 0.5, far = 20.0;
  gl_Position = flat_ ? vec4(p.xy, 0.0, 1.0)
                      : vec4(p.x * 1.2, p.y * 1.6, -p.z * (far + near) / (far - near) - 2.0 * far * near / (far - near),
                             -p.z);
  vertex_color = color;
}"""
FRAGMENT_SHADER = b"""#version 300 es
precision mediump float;
in vec4 vertex_color;
out vec4 color;
void main() { color = vertex_color; }"""

# Constants of EGL and OpenGL ES, from their specifications.
EGL_SURFACE_TYPE, EGL_WINDOW_BIT, EGL_RENDERABLE_TYPE, EGL_ES3_BIT = 0x3033, 4, 0x3040, 0x40
EGL_DEPTH_SIZE, EGL_RED_SIZE, EGL_NONE, EGL_CLIENT_VERSION, EGL_OPENGL_ES_API = 0x3025, 0x3024, 0x3038, 0x3098, 0x30A0
GL_COLOR_BUFFER_BIT, GL_DEPTH_BUFFER_BIT, GL_DEPTH_TEST, GL_SCISSOR_TEST = 0x4000, 0x100, 0xB71, 0xC11
GL_POLYGON_OFFSET_FILL, GL_BLEND, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_LEQUAL = 0x8037, 0xBE2, 0x302, 0x303, 0x203
GL_TRIANGLE_STRIP, GL_FLOAT, GL_ARRAY_BUFFER, GL_STATIC_DRAW = 5, 0x1406, 0x8892, 0x88E4
GL_VERTEX_SHADER, GL_FRAGMENT_SHADER = 0x8B31, 0x8B30


def library(name):
    path = ctypes.util.find_library(name)
    if path is None:
        sys.exit(f"lib{name} is not installed")
    return ctypes.CDLL(path)


def open_window():
    """(X11's library, display, window)"""
    x11 = library("X11")
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XDefaultRootWindow.restype = x11.XCreateSimpleWindow.restype = ctypes.c_ulong
    display = ctypes.c_void_p(x11.XOpenDisplay(None))
    if not display:
        sys.exit("no display")
    root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
    window = ctypes.c_ulong(x11.XCreateSimpleWindow(display, root, 0, 0, WIDTH, HEIGHT, 0, ctypes.c_ulong(0),
                                                    ctypes.c_ulong(0)))
    x11.XMapWindow(display, window)
    x11.XSync(display, 0)
    return display, window


def start_egl(display, window, wanted=(), surface=()):
    """A function that shows what was drawn. `wanted` and `surface`: more attributes, and their values, of EGL's
    configuration and of the window's surface."""
    egl = library("EGL")
    for name in ("eglGetDisplay", "eglCreateWindowSurface", "eglCreateContext"):
        getattr(egl, name).restype = ctypes.c_void_p
    device = ctypes.c_void_p(egl.eglGetDisplay(display))
    config, count = ctypes.c_void_p(), ctypes.c_int()
    wanted = (EGL_SURFACE_TYPE, EGL_WINDOW_BIT, EGL_RENDERABLE_TYPE, EGL_ES3_BIT, EGL_DEPTH_SIZE, 24, EGL_RED_SIZE, 8,
              *wanted, EGL_NONE)
    wanted = (ctypes.c_int * len(wanted))(*wanted)
    if not (egl.eglInitialize(device, None, None) and egl.eglBindAPI(EGL_OPENGL_ES_API)
            and egl.eglChooseConfig(device, wanted, ctypes.byref(config), 1, ctypes.byref(count)) and count.value):
        sys.exit("no OpenGL ES 3")
    surface = (ctypes.c_int * (len(surface) + 1))(*surface, EGL_NONE)
    surface = ctypes.c_void_p(egl.eglCreateWindowSurface(device, config, window, surface))
    context = ctypes.c_void_p(egl.eglCreateContext(device, config, None, (ctypes.c_int * 3)(EGL_CLIENT_VERSION, 3,
                                                                                           EGL_NONE)))
    if not egl.eglMakeCurrent(device, surface, surface, context):
        sys.exit("no context of OpenGL ES 3")
    return lambda: egl.eglSwapBuffers(device, surface)


def make_program(gl, vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER):
    program = gl.glCreateProgram()
    for kind, text in ((GL_VERTEX_SHADER, vertex_shader), (GL_FRAGMENT_SHADER, fragment_shader)):
        shader = gl.glCreateShader(kind)
        gl.glShaderSource(shader, 1, ctypes.byref(ctypes.c_char_p(text)), None)
        gl.glCompileShader(shader)
        gl.glAttachShader(program, shader)
    gl.glLinkProgram(program)
    gl.glUseProgram(program)
    return program


def quad(corners, colors):
    """Four vertices of a strip, as bytes: positions (x, y, z) and colours (r, g, b, a)."""
    return b"".join(struct.pack("<7f", *corner, *color) for corner, color in zip(corners, colors))


def flat_quad(x0, y0, x1, y1, z, *colors):
    return quad([(x0, y0, z), (x1, y0, z), (x0, y1, z), (x1, y1, z)], colors if len(colors) == 4 else colors * 4)


FLOOR, DECAL, INSTANCES, CUT, BAR, PANEL = range(6)
QUADS = [
    quad([(-3, -1, -1), (3, -1, -1), (-6, -1, -12), (6, -1, -12)],
         [(0.2, 0.3, 0.2, 1), (0.3, 0.3, 0.2, 1), (0.5, 0.6, 0.7, 1), (0.6, 0.6, 0.7, 1)]),
    quad([(-0.8, -1, -2), (0.9, -1, -2.2), (-0.7, -1, -3.6), (0.6, -1, -3.4)], [(0.9, 0.8, 0.1, 1)] * 4),
    flat_quad(-1.6, -0.9, -0.9, 0.4, -2.5, (0.9, 0.2, 0.1, 1), (0.9, 0.5, 0.1, 1), (0.2, 0.2, 0.9, 1),
              (0.6, 0.1, 0.8, 1)),
    flat_quad(0.2, -0.5, 1.8, 1.2, -3.1, (0.1, 0.7, 0.6, 1)),
    flat_quad(-0.95, 0.8, 0.35, 0.92, 0, (1, 1, 1, 1), (0.2, 0.9, 0.2, 1), (1, 1, 1, 1), (0.2, 0.9, 0.2, 1)),
    flat_quad(0.45, 0.55, 0.95, 0.95, 0, (0.1, 0.1, 0.4, 0.5)),
]


def take_vertices(gl, data):
    """Draws take these vertices of quad() from now on."""
    buffer = ctypes.c_uint()
    gl.glGenBuffers(1, ctypes.byref(buffer))
    gl.glBindBuffer(GL_ARRAY_BUFFER, buffer)
    gl.glBufferData(GL_ARRAY_BUFFER, ctypes.c_ssize_t(len(data)), data, GL_STATIC_DRAW)
    for location, size, offset in ((0, 3, 0), (1, 4, 12)):
        gl.glEnableVertexAttribArray(location)
        gl.glVertexAttribPointer(location, size, GL_FLOAT, 0, 28, ctypes.c_void_p(offset))


def main():
    show = start_egl(*open_window())
    gl = library("GLESv2")
    f = ctypes.c_float
    program = make_program(gl)
    step, is_flat = (gl.glGetUniformLocation(program, name) for name in (b"step", b"flat_"))
    take_vertices(gl, b"".join(QUADS))

    def draw(number, instances=1):
        gl.glDrawArraysInstanced(GL_TRIANGLE_STRIP, 4 * number, 4, instances)

    gl.glDepthFunc(GL_LEQUAL)
    gl.glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA)
    gl.glPolygonOffset(f(-1), f(-2))
    gl.glScissor(52, 30, 20, 24)
    gl.glClearColor(f(0.3), f(0.5), f(0.8), f(1))
    while True:
        gl.glViewport(0, 0, WIDTH, HEIGHT)
        gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
        gl.glEnable(GL_DEPTH_TEST)
        gl.glUniform1i(is_flat, 0)
        gl.glUniform3f(step, f(0), f(0), f(0))
        draw(FLOOR)
        gl.glEnable(GL_POLYGON_OFFSET_FILL)
        draw(DECAL)
        gl.glDisable(GL_POLYGON_OFFSET_FILL)
        gl.glUniform3f(step, f(0.55), f(0.1), f(-0.7))
        draw(INSTANCES, 6)
        gl.glEnable(GL_SCISSOR_TEST)
        draw(CUT)
        gl.glDisable(GL_SCISSOR_TEST)
        gl.glDisable(GL_DEPTH_TEST)
        gl.glUniform3f(step, f(0), f(0), f(0))
        gl.glUniform1i(is_flat, 1)
        draw(BAR)
        gl.glEnable(GL_BLEND)
        draw(PANEL)
        gl.glDisable(GL_BLEND)
        show()


if __name__ == "__main__":
    main()
