"""
Which bearing order will I hear?
================================

The pinion runs up from 1000 to 8000 rpm. Each ray is an order of the mesh frequency. The bearing force is
largest where a ray meets a natural frequency (red): this order is heard at this speed.
"""

import xarray as xr
from matplotlib.figure import Figure

import spurcheck
from validation.plots.maps import waterfall_figure

PAIR = spurcheck.load_gear_pair("nasa_28_28")


def compute() -> xr.Dataset:
    """Amplitudes of the bearing force over speed and mesh order."""
    run = spurcheck.run_up(PAIR, (1000, 8000), seconds=0.8)
    return spurcheck.waterfall(run, variable="bearing_force_x_p")


def draw(result: xr.Dataset) -> Figure:
    """Waterfall with the natural frequencies."""
    return waterfall_figure(result, spurcheck.natural_frequencies(PAIR).to_numpy())


if __name__ == "__main__":
    found = compute()
    orders = found["amplitude"].sel(order=range(1, 6), method="nearest")
    loudest = orders.isel(orders.argmax(...))
    print(f"order {float(loudest.order):.0f}, {float(loudest.speed_rpm):.0f} rpm: {float(loudest):.0f} N")
    draw(found).savefig("bearing_orders.png", dpi=150)
