"""What a camera's rays tell about its lens: illumination, spots, MTF, distortion, ray fans, field curvature; as arrays.

Film points are raster positions in pixels, as `image_xy` of `Camera.rays`. All is geometric optics: without diffraction.
"""

from .fans import Fans, fans, field_curvature
from .field import distortion, relative_illumination
from .spots import Spots, mtf, spots

__all__ = ["Fans", "Spots", "distortion", "fans", "field_curvature", "mtf", "relative_illumination", "spots"]
