"""Asks all windows of an X display to draw themselves again, for programs that draw only when something changes."""
import ctypes
import ctypes.util


def _windows(x11, display, window):
    root, parent, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_uint()
    children = ctypes.POINTER(ctypes.c_ulong)()
    if not x11.XQueryTree(display, ctypes.c_ulong(window), ctypes.byref(root), ctypes.byref(parent),
                          ctypes.byref(children), ctypes.byref(count)):
        return
    found = [children[k] for k in range(count.value)]
    if children:
        x11.XFree(children)
    for child in found:
        yield child
        yield from _windows(x11, display, child)


def ask_for_redraw(name):
    """Sends an Expose event to every window of the display. Does nothing if there is no X library."""
    library = ctypes.util.find_library("X11")
    if not library:
        return
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XDefaultRootWindow.restype = ctypes.c_ulong
    opened = x11.XOpenDisplay(name.encode())
    if not opened:
        return
    display = ctypes.c_void_p(opened)
    ignore = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda *_: 0)
    x11.XSetErrorHandler(ignore)  # a window may be gone before it is asked
    for window in list(_windows(x11, display, x11.XDefaultRootWindow(display))):
        x11.XClearArea(display, ctypes.c_ulong(window), 0, 0, 0, 0, 1)
    x11.XSync(display, 0)
    x11.XCloseDisplay(display)
    x11.XSetErrorHandler(None)
