"""Write `links.pair`, two links of a chain, for `links.c`."""

import numpy as np

import standoff as so
from standoff.c_interface import save_pair
from standoff.geometry import Torus
from standoff.solids import Solid

half = np.pi / 2
patches = [Torus(1.0, 0.2, v0=-half, v1=half), Torus(1.0, 0.2, v0=half, v1=3 * half)]
link = Solid.from_patches(patches, name="link")

save_pair("links.pair", so.Tracker(link, link))
