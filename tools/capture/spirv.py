"""The inputs of a SPIR-V fragment shader, from its decorations (SPIR-V specification, 3.20): how they vary over a
triangle, and which one is the place in a point."""
import struct

_MEMBER_DECORATE, _DECORATE = 72, 71  # instructions
_BUILTIN, _NO_PERSPECTIVE, _FLAT, _LOCATION = 11, 13, 14, 30  # decorations
_POINT_COORD = 16  # a builtin
_VARIABLE, _INPUT = 59, 1


def _instructions(words):
    place = 5  # after the header
    while place < len(words):
        count = max(1, words[place] >> 16)
        yield words[place] & 0xFFFF, words[place + 1: place + count]
        place += count


def with_point_coordinates(module, location):
    """The module with gl_PointCoord as an input at a location, and whether it has one. `module`: bytes."""
    words = list(struct.unpack(f"<{len(module) // 4}I", module[: len(module) // 4 * 4]))
    place, found = 5, False
    while place < len(words):
        count = max(1, words[place] >> 16)
        if words[place] == 4 << 16 | _DECORATE and words[place + 2: place + 4] == [_BUILTIN, _POINT_COORD]:
            words[place + 2: place + 4] = [_LOCATION, location]
            found = True
        place += count
    return (struct.pack(f"<{len(words)}I", *words), True) if found else (module, False)


def interpolations(module):
    """(first location, "smooth" | "linear" | "flat") of each input of a module with one entry point, in the order of
    locations. A matrix or an array takes the locations that follow, too. `module`: bytes."""
    words = struct.unpack(f"<{len(module) // 4}I", module[: len(module) // 4 * 4])
    locations, marks, inputs, has_members = {}, {}, set(), set()
    for code, operands in _instructions(words):
        if code == _DECORATE:
            key, decoration = (operands[0], None), operands[1:]
        elif code == _MEMBER_DECORATE:
            key, decoration = (operands[0], operands[1]), operands[2:]
            has_members.add(key)
        else:
            if code == _VARIABLE and operands[2] == _INPUT:
                inputs.add((operands[1], None))
            continue
        if decoration[0] == _LOCATION:
            locations[key] = decoration[1]
        elif decoration[0] in (_FLAT, _NO_PERSPECTIVE):
            marks[key] = "flat" if decoration[0] == _FLAT else "linear"
    return sorted((location, marks.get(key, "smooth")) for key, location in locations.items()
                  if key in inputs or key in has_members)


def interpolation_at(found, location):
    """What interpolations() found at a location."""
    before = [way for first, way in found if first <= location]
    return before[-1] if before else "smooth"
