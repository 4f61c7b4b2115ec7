"""A small program that draws with OpenGL ES 3 what own_program.py has, to targets of several kinds, until it is ended:
`own_targets.py WHAT`. WHAT: window_srgb (a window whose colours are encoded for sRGB), object_srgb (a framebuffer
object of a format of sRGB), object_codes (the same without encoding), mixed_srgb (without for the last draw), uncleared
(neither colour nor depth is cleared after the first frame), part (a part of the colours is cleared to another one)."""
import ctypes
import sys

from own_program import (FLOOR, GL_BLEND, GL_COLOR_BUFFER_BIT, GL_DEPTH_BUFFER_BIT, GL_DEPTH_TEST, GL_LEQUAL,
                         GL_ONE_MINUS_SRC_ALPHA, GL_SCISSOR_TEST, GL_SRC_ALPHA, GL_TRIANGLE_STRIP, HEIGHT, INSTANCES,
                         PANEL, QUADS, WIDTH, library, make_program, open_window, start_egl, take_vertices)

EGL_GL_COLORSPACE, EGL_GL_COLORSPACE_SRGB = 0x309D, 0x3089
GL_FRAMEBUFFER_SRGB, GL_SRGB8_ALPHA8, GL_DEPTH_COMPONENT24 = 0x8DB9, 0x8C43, 0x81A6
GL_FRAMEBUFFER, GL_READ_FRAMEBUFFER, GL_DRAW_FRAMEBUFFER, GL_RENDERBUFFER = 0x8D40, 0x8CA8, 0x8CA9, 0x8D41
GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT, GL_NEAREST = 0x8CE0, 0x8D00, 0x2600


def make_object(gl):
    """The number of a framebuffer object whose colours are of sRGB, with depth."""
    number = ctypes.c_uint()
    gl.glGenFramebuffers(1, ctypes.byref(number))
    gl.glBindFramebuffer(GL_FRAMEBUFFER, number)
    for format, place in ((GL_SRGB8_ALPHA8, GL_COLOR_ATTACHMENT0), (GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT)):
        buffer = ctypes.c_uint()
        gl.glGenRenderbuffers(1, ctypes.byref(buffer))
        gl.glBindRenderbuffer(GL_RENDERBUFFER, buffer)
        gl.glRenderbufferStorage(GL_RENDERBUFFER, format, WIDTH, HEIGHT)
        gl.glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer)
    return number


def main(what):
    surface = (EGL_GL_COLORSPACE, EGL_GL_COLORSPACE_SRGB) if what == "window_srgb" else ()
    show = start_egl(*open_window(), surface=surface)
    gl = library("GLESv2")
    f = ctypes.c_float
    program = make_program(gl)
    step, is_flat = (gl.glGetUniformLocation(program, name) for name in (b"step", b"flat_"))
    take_vertices(gl, b"".join(QUADS))
    has_object = what in ("object_srgb", "object_codes", "mixed_srgb")
    target = make_object(gl) if has_object else 0
    gl.glDepthFunc(GL_LEQUAL)
    gl.glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA)
    gl.glScissor(60, 10, 30, 40)
    gl.glViewport(0, 0, WIDTH, HEIGHT)
    gl.glEnable(GL_DEPTH_TEST)
    is_first = True
    while True:
        gl.glBindFramebuffer(GL_FRAMEBUFFER, target)
        if what == "object_codes":
            gl.glDisable(GL_FRAMEBUFFER_SRGB)
        elif has_object:
            gl.glEnable(GL_FRAMEBUFFER_SRGB)
        gl.glClearColor(f(0.3), f(0.5), f(0.8), f(1))
        if is_first or what != "uncleared":
            gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)
        is_first = False
        if what == "part":
            gl.glEnable(GL_SCISSOR_TEST)
            gl.glClearColor(f(1), f(0), f(0), f(1))
            gl.glClear(GL_COLOR_BUFFER_BIT)
            gl.glDisable(GL_SCISSOR_TEST)
        gl.glUniform1i(is_flat, 0)
        gl.glUniform3f(step, f(0), f(0), f(0))
        gl.glDrawArrays(GL_TRIANGLE_STRIP, 4 * FLOOR, 4)
        gl.glUniform3f(step, f(0.55), f(0.1), f(-0.7))
        gl.glDrawArraysInstanced(GL_TRIANGLE_STRIP, 4 * INSTANCES, 4, 6)
        gl.glUniform3f(step, f(0), f(0), f(0))
        gl.glUniform1i(is_flat, 1)
        if what == "mixed_srgb":
            gl.glDisable(GL_FRAMEBUFFER_SRGB)
        gl.glEnable(GL_BLEND)
        gl.glDrawArrays(GL_TRIANGLE_STRIP, 4 * PANEL, 4)
        gl.glDisable(GL_BLEND)
        if has_object:
            gl.glBindFramebuffer(GL_READ_FRAMEBUFFER, target)
            gl.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0)
            gl.glBlitFramebuffer(0, 0, WIDTH, HEIGHT, 0, 0, WIDTH, HEIGHT, GL_COLOR_BUFFER_BIT, GL_NEAREST)
        show()


if __name__ == "__main__":
    main(sys.argv[1])
