# SPDX-License-Identifier: Apache-2.0
"""Drops a file on a window of X11, as a file manager does: drop_file.py WINDOW FILE. The protocol is XDND 5."""

import ctypes
import ctypes.util
import pathlib
import sys
import time

X = ctypes.CDLL(ctypes.util.find_library("X11"))
Id, Pointer, Int = ctypes.c_ulong, ctypes.c_void_p, ctypes.c_int


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", Int), ("serial", Id), ("send_event", Int), ("display", Pointer), ("window", Id), ("message_type", Id), ("format", Int),
                ("data", ctypes.c_long * 5)]


class Selection(ctypes.Structure):
    """A request; the answer has the same members but for `owner`."""
    _fields_ = [("type", Int), ("serial", Id), ("send_event", Int), ("display", Pointer), ("owner", Id), ("requestor", Id), ("selection", Id),
                ("target", Id), ("property", Id), ("time", Id)]


class Answer(ctypes.Structure):
    _fields_ = [field for field in Selection._fields_ if field[0] != "owner"]


class Event(ctypes.Union):
    _fields_ = [("type", Int), ("client", ClientMessage), ("request", Selection), ("answer", Answer), ("room", ctypes.c_long * 24)]


for name, result, arguments in (("XOpenDisplay", Pointer, [ctypes.c_char_p]), ("XDefaultRootWindow", Id, [Pointer]),
                                ("XInternAtom", Id, [Pointer, ctypes.c_char_p, Int]), ("XPending", Int, [Pointer]),
                                ("XCreateSimpleWindow", Id, [Pointer, Id, Int, Int, Int, Int, Int, Id, Id]),
                                ("XSetSelectionOwner", Int, [Pointer, Id, Id, Id]), ("XNextEvent", Int, [Pointer, ctypes.POINTER(Event)]),
                                ("XSendEvent", Int, [Pointer, Id, Int, ctypes.c_long, ctypes.POINTER(Event)]), ("XFlush", Int, [Pointer]),
                                ("XChangeProperty", Int, [Pointer, Id, Id, Id, Int, Int, ctypes.c_char_p, Int])):
    function = getattr(X, name)
    function.restype, function.argtypes = result, arguments

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY, ATOM = 33, 30, 31, 4


def main(target, path):
    display = X.XOpenDisplay(None)
    atom = {name: X.XInternAtom(display, name.encode(), 0)
            for name in ("XdndEnter", "XdndPosition", "XdndStatus", "XdndDrop", "XdndFinished", "XdndSelection", "XdndActionCopy", "text/uri-list")}
    source = X.XCreateSimpleWindow(display, X.XDefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0)
    X.XSetSelectionOwner(display, atom["XdndSelection"], source, 0)

    def tell(message, *data):
        event = Event()
        event.client = ClientMessage(CLIENT_MESSAGE, 0, 1, display, target, atom[message], 32, (ctypes.c_long * 5)(source, *data))
        X.XSendEvent(display, target, 0, 0, ctypes.byref(event))
        X.XFlush(display)

    tell("XdndEnter", 5 << 24, atom["text/uri-list"], 0, 0)
    tell("XdndPosition", 0, (200 << 16) | 200, 0, atom["XdndActionCopy"])
    uri = pathlib.Path(path).absolute().as_uri().encode() + b"\r\n"
    deadline, event = time.monotonic() + 30, Event()
    while time.monotonic() < deadline:
        if not X.XPending(display):
            time.sleep(.02)
            continue
        X.XNextEvent(display, ctypes.byref(event))
        if event.type == CLIENT_MESSAGE and event.client.message_type == atom["XdndStatus"]:
            tell("XdndDrop", 0, 0, 0, 0)
        elif event.type == CLIENT_MESSAGE and event.client.message_type == atom["XdndFinished"]:
            return 0
        elif event.type == SELECTION_REQUEST:
            request = event.request
            X.XChangeProperty(display, request.requestor, request.property, request.target, 8, 0, uri, len(uri))
            reply = Event()
            reply.answer = Answer(SELECTION_NOTIFY, 0, 1, display, request.requestor, request.selection, request.target, request.property, request.time)
            X.XSendEvent(display, request.requestor, 0, 0, ctypes.byref(reply))
            X.XFlush(display)
    print("the window did not take the file", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2]))
