"""The pinhole camera that fits a lens best, as OpenCV writes it.

$ python intrinsics.py wide.22mm
"""

import sys

import realistic


def main(lens: str) -> None:
    camera = realistic.Camera(lens, resolution=(1920, 1280), focus_distance=2000.0)
    found = realistic.measure.intrinsics(camera)
    print("camera matrix, pixels:")
    print(found.matrix.round(3))
    print("distortion k1 k2 p1 p2 k3:", found.distortion.round(6))
    print(f"residual: {found.residual_rms:.4f} pixels RMS, {found.residual_max:.4f} at most")
    print(f"pinhole: {-found.position[2]:.3f} mm behind the front vertex; fitted {found.distance:.1f} mm from it")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print("usage: python intrinsics.py LENS, as in: python intrinsics.py wide.22mm", file=sys.stderr)
        sys.exit(2)
    main(sys.argv[1])
