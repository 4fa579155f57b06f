"""Small Acclaim skeletons and motions for tests."""

import re

ARM = """
begin id 5 name {s}clavicle direction {x} 0 0 length 3 axis 0 0 0 XYZ end
begin id 6 name {s}humerus direction {x} 0 0 length 6 axis {axis} dof rx ry rz limits (-1 1) end
begin id 7 name {s}radius direction {x} 0 0 length 5 axis 0 0 0 XYZ dof ry end
begin id 8 name {s}wrist direction {x} 0 0 length 1 axis 0 0 0 XYZ end"""
SKELETON = """# a person with arms to the sides, y up and z ahead
:version 1.10
:units
  mass 1.0
  length 0.45
  angle {unit}
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
begin id 1 name lowerback direction 0 1 0 length 4 axis 0 0 0 XYZ dof rx ry rz end
begin id 2 name upperback direction 0 1 0 length 4 axis 0 0 0 XYZ end
begin id 3 name lowerneck direction 0 1 0 length 1 axis 0 0 0 XYZ end
begin id 4 name head direction 0 1 0 length 2 axis 0 0 0 XYZ dof rx end
{left}
{right}
:hierarchy
  begin
    root lowerback
    lowerback upperback
    upperback lowerneck lclavicle rclavicle
    lowerneck head
    lclavicle lhumerus
    lhumerus lradius
    lradius lwrist
    rclavicle rhumerus
    rhumerus rradius
    rradius rwrist
  end
"""
KEYWORDS = re.compile(r" (id|name|direction|length|axis|dof|limits|end)\b")
STILL = {"root": "0 17 0 0 0 0", "lowerback": "0 0 0", "head": "0", "lhumerus": "0 0 0", "rhumerus": "0 0 0"}


def acclaim_skeleton(*, axis="0 0 0 XYZ", unit="deg") -> bytes:
    """Write a skeleton whose left upper arm has the given axes."""
    left, right = ARM.format(s="l", x=1, axis=axis), ARM.format(s="r", x=-1, axis="0 0 0 XYZ")
    text = SKELETON.format(left=left, right=right, unit=unit)
    return re.sub(r"(?m)^begin .*$", lambda bone: KEYWORDS.sub(r"\n\1", bone[0]), text).encode()


def acclaim_motion(frames=3, *, heading=":FULLY-SPECIFIED\n:DEGREES", **bones) -> bytes:
    """Write equal frames, with given angles of some bones and zero elsewhere."""
    rows = {**STILL, "lradius": "0", "rradius": "0", **bones}
    lines = ["#!OML:ASF", heading]
    for frame in range(1, frames + 1):
        lines += [str(frame), *(f"{bone} {numbers}" for bone, numbers in rows.items())]
    return "\n".join(lines).encode()
