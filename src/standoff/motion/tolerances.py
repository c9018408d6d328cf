"""Every tolerance of this layer, with its unit and its reason."""

from typing import Final

#: No unit. Greatest component of ``RᵀR − I`` in an accepted rotation matrix, and greatest error of
#: the last row of a homogeneous matrix. Double precision gives 1e-15 and long products of rotations
#: 1e-12; nine digits also admit matrices read from files that keep ten. A larger defect would show
#: in distances at the level that the library certifies.
ORTHONORMALITY: Final = 1e-9

#: No unit. Greatest component of ``RᵀR − I`` in a matrix that counts as a rotation rounded when it
#: was stored: the nearest rotation is taken in its place, and reported. Single precision leaves
# 2e-7, : and 1e-6 after long products of rotations; text with six decimals leaves 2e-6. Beyond five
# times : that, a scale or a shear may be meant. No axis moves by more than 1.5 times this.
ROUNDED: Final = 1e-5

#: No unit. Least over greatest singular value of a matrix that has a nearest rotation. Below it
#: single precision does not tell the sign of the determinant, on which a whole half turn depends.
FLAT: Final = 1e-6

#: No unit. Greatest ``| |q| − 1 |`` of an accepted quaternion. Trajectory files keep four decimals,
#: which leaves up to 1e-4; beyond ten times that the four numbers are something else, most often in
#: another order or not a quaternion.
UNIT_QUATERNION: Final = 1e-3

#: No unit. Below this ``| |q| − 1 |`` bringing it to unit norm is not reported. The same size as
#: `ORTHONORMALITY`: a rotation matrix that far off is accepted without a word too.
QUATERNION_ROUNDING: Final = 1e-9

#: Radian. Two samples whose rotations differ by a half turn to within this have two shortest
#: screws between them. The accuracy to which rotations are accepted decides which would be taken.
HALF_TURN_ANGLE: Final = 1e-9

#: No unit. Trace of a turn that may be a half one, whose trace is −1: rotations have a defect, of
#: up to ``ORTHONORMALITY``, and the trace rises with the square of the angle that is missing.
NEAR_HALF_TURN: Final = -1.0 + 1e-6

#: No unit. Part of the greatest of a few numbers that are shown together below which one is shown
#: as 0: the roundoff of composing rotations.
SHOWN_DIGITS: Final = 1e-15
