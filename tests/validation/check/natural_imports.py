"""Files and objects as programs and engineers write them, each with what it says in SI.

A row returns the source and what must be read: quantity -> values, or "places" -> abscissa; a text: the words
of the refusal.
"""

from __future__ import annotations

import datetime
from collections.abc import Callable

import h5py
import numpy as np
import openpyxl
import pandas as pd
import scipy.io
import xarray as xr

from tests.validation.check.known_curves import OTHER, Known, rows

PI = np.pi
ROWS: dict[str, Callable] = {}


def row(function):
    ROWS[function.__name__] = function
    return function


def text(folder, name, content, encoding="utf-8"):
    (folder / name).write_bytes(content.encode(encoding))
    return folder / name


# ---- text ------------------------------------------------------------------------------------------------


@row
def pandas_csv_with_numbered_rows(k, folder):
    lines = [
        f"{n},{t:.9e},{1e3 * x / 0.0254:.9e}" for n, (t, x) in enumerate(zip(k.time, k.x_g, strict=True))
    ]
    return text(folder, "p.csv", ",Time_s,x_g [mil]\n" + "\n".join(lines)), {"places": k.time, "x_g": k.x_g}


@row
def unknown_letter(k, folder):
    return text(
        folder, "e.csv", "t,ε\n" + rows(k.time, k.dte)
    ), "theirs = ε: allowed a column named by one of"


@row
def csv_in_si_without_units(k, folder):
    return text(folder, "a.csv", "time,dte,x_p\n" + rows(k.time, k.dte, k.x_p)), {
        "places": k.time, "dte": k.dte, "x_p": k.x_p,
        "remark": "Columns without a unit are read in SI: time, dte, x_p.",
    }  # fmt: skip


@row
def german_excel_csv(k, folder):
    head = "Zeit [s];Drehfehler [µm];Lagerkraft x Ritzel [N];Drehzahl Ritzel [1/min]\r\n"
    speed = k.pair.operating.pinion_speed + 0.0 * k.time
    body = rows(k.time, 1e6 * k.dte, k.bearing_force_x_p, speed * 30 / PI, delimiter=";", decimal=",")
    return text(folder, "Messung.csv", head + body.replace("\n", "\r\n"), "cp1252"), {
        "places": k.time, "dte": k.dte, "bearing_force_x_p": k.bearing_force_x_p, "theta_p_dot": speed,
        "remark": "decimal comma",
    }  # fmt: skip


@row
def german_excel_csv_with_mark_and_row_of_units(k, folder):
    head = "Zeit;Drehwegabweichung;Zahnkraft\ns;µm;kN\n"
    body = rows(k.time, 1e6 * k.dte, 1e-3 * k.mesh_force, delimiter=";", decimal=",")
    return text(folder, "b.csv", head + body, "utf-8-sig"), {
        "places": k.time, "dte": k.dte, "mesh_force": k.mesh_force,
    }  # fmt: skip


@row
def excel_unicode_text(k, folder):
    head = "t [ms]\tTE [µm]\tFm [kN]\n"
    body = rows(1e3 * k.time, 1e6 * k.dte, 1e-3 * k.mesh_force, delimiter="\t")
    return text(folder, "c.txt", head + body, "utf-16"), {
        "places": k.time, "dte": k.dte, "mesh_force": k.mesh_force,
    }  # fmt: skip


@row
def matlab_writetable(k, folder):
    body = rows(k.time, k.x_p, k.x_g, k.theta_p, k.theta_g)
    return text(folder, "out.csv", "t,x1,x2,theta1,theta2\n" + body), {
        "places": k.time, "x_p": k.x_p, "x_g": k.x_g, "theta_p": k.theta_p, "theta_g": k.theta_g,
        "remark": "gear 1 is the pinion",
    }  # fmt: skip


@row
def matlab_writematrix(k, folder):
    return text(folder, "out.csv", rows(k.time, k.dte)), "time [s], dte [um]"


@row
def matlab_save_ascii(k, folder):
    body = rows(k.time, k.dte, delimiter="   ", number="{:.7e}")
    return text(folder, "out.txt", "   " + body.replace("\n", "\n   ")), "no headings"


@row
def comment_of_numpy_savetxt(k, folder):
    body = rows(k.time, k.dte, k.mesh_force, delimiter=" ")
    return text(folder, "out.dat", "# model of run 3\n# time dte_um F_mesh_N\n" + rows(
        k.time, 1e6 * k.dte, k.mesh_force, delimiter=" ")), {
        "places": k.time, "dte": k.dte, "mesh_force": k.mesh_force,
    } if body else ""  # fmt: skip


@row
def adams_table(k, folder):
    head = (
        "A. .gear_stage.Analysis 1.43\n   Last_Run  2026-03-02\n\n"
        "Time\tTransmission_Error\tContact_Force\tPINION_Angular_Velocity\n(sec)\t(mm)\t(newton)\t(deg/sec)\n"
    )
    speed = k.pair.operating.pinion_speed + 0.0 * k.time
    body = rows(k.time, 1e3 * k.dte, k.mesh_force, np.degrees(speed), delimiter="\t")
    return text(folder, "adams.tab", head + body), {
        "places": k.time, "dte": k.dte, "mesh_force": k.mesh_force, "theta_p_dot": speed,
        "remark": "2 lines before the headings",
    }  # fmt: skip


@row
def simpack_columns(k, folder):
    head = "! SIMPACK result\n! time [s]   x_pinion [mm]   y_pinion [mm]   phi_p [deg]\n"
    body = rows(k.time, 1e3 * k.x_p, 1e3 * k.y_p, np.degrees(k.theta_p), delimiter="   ")
    return text(folder, "simpack.asc", head + body), {
        "places": k.time, "x_p": k.x_p, "y_p": k.y_p, "theta_p": k.theta_p,
    }  # fmt: skip


@row
def labview_measurement(k, folder):
    head = (
        "LabVIEW Measurement\t\nWriter_Version\t2\t\nSeparator\tTab\t\nDecimal_Separator\t.\t\n"
        "***End_of_Header***\t\t\t\nChannels\t2\t\t\nSamples\t161\t161\t\n***End_of_Header***\t\t\t\n"
        "X_Value\tTE (um)\tacceleration pinion x (g)\tComment\n"
    )
    body = rows(k.time, 1e6 * k.dte, k.x_p_ddot / 9.80665, delimiter="\t").replace("\n", "\t\n")
    return text(folder, "rig.lvm", head + body), {"places": k.time, "dte": k.dte, "x_p_ddot": k.x_p_ddot}


@row
def fortran_exponents(k, folder):
    body = rows(k.time, k.dte, delimiter="  ").replace("e", "D")
    return text(folder, "f.out", "  TIME  DTE\n" + body), {"places": k.time, "dte": k.dte}


@row
def quoted_headings_with_commas(k, folder):
    head = '"time, s","transmission error, um","bearing force x pinion, kN"\n'
    return text(folder, "q.csv", head + rows(k.time, 1e6 * k.dte, 1e-3 * k.bearing_force_x_p)), {
        "places": k.time, "dte": k.dte, "bearing_force_x_p": k.bearing_force_x_p,
    }  # fmt: skip


@row
def quoted_decimal_commas(k, folder):
    body = rows(k.time, 1e6 * k.dte, delimiter='"|"', decimal=",").replace("|", ",").replace("\n", '"\n"')
    return text(folder, "q.csv", f't [s],TE [um]\n"{body}"'), {"places": k.time, "dte": k.dte}


@row
def din_headings(k, folder):
    body = rows(k.time, np.degrees(k.theta_g), 1e6 * k.y_g, delimiter="\t", decimal=",")
    return text(folder, "d.txt", "t / s\tθ_g in °\ty_g / µm\n" + body), {
        "places": k.time, "theta_g": k.theta_g, "y_g": k.y_g,
    }  # fmt: skip


@row
def loads_of_tooth_pairs(k, folder):
    head = "t;N A;N B;F A [kN]\n"
    body = rows(k.time, k.mesh_force, 2 * k.mesh_force, 1e-3 * k.friction, delimiter=";", decimal=",")
    return text(folder, "n.csv", head + body), {
        "places": k.time, "normal_load_A": k.mesh_force, "normal_load_B": 2 * k.mesh_force,
        "friction_force_A": k.friction,
    }  # fmt: skip


@row
def rates_and_accelerations(k, folder):
    head = "time [s],TE velocity [mm/s],vx1 [mm/s],theta_p_ddot [deg/s^2],mesh stiffness [N/um]\n"
    body = rows(k.time, 1e3 * k.dte_dot, 1e3 * k.x_p_dot, np.degrees(k.theta_p_ddot), 1e-6 * k.mesh_stiffness)
    return text(folder, "r.csv", head + body), {
        "dte_dot": k.dte_dot, "x_p_dot": k.x_p_dot, "theta_p_ddot": k.theta_p_ddot,
        "mesh_stiffness": k.mesh_stiffness,
    }  # fmt: skip


@row
def extra_columns_are_named(k, folder):
    head = "time [s],foo,dte [um],oil temperature [degC],state\n"
    lines = [f"{t:.9e},1,{1e6 * d:.9e},70,ok" for t, d in zip(k.time, k.dte, strict=True)]
    return text(folder, "e.csv", head + "\n".join(lines)), {
        "dte": k.dte, "remark": "3 columns were not used: foo, oil temperature [degC], state",
    }  # fmt: skip


@row
def whole_rotations(k, folder):
    head = "t [s],phi_p [deg],phi_g [deg]\n"
    turns = 6.0 + k.pair.operating.pinion_speed * k.time + k.theta_p
    wrapped = np.mod(np.degrees(turns), 360.0)
    gear = k.turn_g + k.theta_g
    return text(folder, "w.csv", head + rows(k.time, wrapped, np.degrees(gear), number="{:.12e}")), {
        "theta_p": turns, "theta_g": gear,
    }  # fmt: skip


# ---- other abscissae -------------------------------------------------------------------------------------


@row
def pinion_angle_in_degrees(k, folder):
    head = "pinion angle [deg],dte [um]\n"
    return text(folder, "a.csv", head + rows(np.degrees(k.turn_p), 1e6 * k.dte)), {
        "places": k.s, "abscissa": "mesh_cycles", "dte": k.dte,
    }  # fmt: skip


@row
def wrapped_gear_angle_in_rad(k, folder):
    head = "gear rotation angle [rad];TE [µm]\n"
    angle = np.mod(k.turn_g + 6.0, 2.0 * PI)
    start = 6.0 * k.pair.gear.teeth / (2.0 * PI)
    return text(folder, "g.csv", head + rows(angle, 1e6 * k.dte, delimiter=";")), {
        "places": k.s + start, "abscissa": "mesh_cycles", "dte": k.dte,
    }  # fmt: skip


@row
def mesh_phase(k, folder):
    return {"mesh phase [deg]": 360.0 * k.s, "F_mesh [kN]": 1e-3 * k.mesh_force}, {
        "places": k.s, "abscissa": "mesh_cycles", "mesh_force": k.mesh_force,
    }  # fmt: skip


def _spectrum(k, name):
    mean, amplitude, phase = k.waves[name]
    complex_amplitudes = np.array(
        [mean, amplitude * np.exp(1j * phase), 0.25 * amplitude * np.exp(-1j * phase)]
    )
    s = np.arange(256) / 256
    values = mean + amplitude * np.cos(2 * PI * s + phase) + 0.25 * amplitude * np.cos(4 * PI * s - phase)
    return complex_amplitudes, values


@row
def orders_with_phases(k, folder):
    amplitudes, values = _spectrum(k, "dte")
    head = "order,dte amplitude [um],dte phase [deg]\n"
    phases = np.angle(amplitudes, deg=True)
    return text(folder, "o.csv", head + rows(np.arange(3), 1e6 * np.abs(amplitudes), phases)), {
        "abscissa": "mesh_cycles", "dte": values,
    }  # fmt: skip


@row
def orders_with_a_phase_of_no_name(k, folder):
    amplitudes, values = _spectrum(k, "mesh_force")
    head = "order;Fm [kN];phase [deg]\n"
    body = rows(np.arange(3), 1e-3 * np.abs(amplitudes), np.angle(amplitudes, deg=True), delimiter=";")
    return text(folder, "o.csv", head + body), {"abscissa": "mesh_cycles", "mesh_force": values}


@row
def torque_beside_time(k, folder):
    head = "t [s],T [N m],speed [rpm],dte [um]\n"
    return text(folder, "t.csv", head + rows(k.time, k.mesh_force, k.friction, 1e6 * k.dte)), {
        "places": k.time, "dte": k.dte, "remark": "not used: T [N m], speed [rpm]",
    }  # fmt: skip


@row
def complex_orders_of_a_mapping(k, folder):
    amplitudes, values = _spectrum(k, "x_p")
    return {"order": [0, 1, 2], "x_p": amplitudes}, {"abscissa": "mesh_cycles", "x_p": values}


@row
def orders_without_phases(k, folder):
    head = "mesh order,TE [um]\n"
    return text(folder, "o.csv", head + rows([1, 2], [1.5, 0.4])), {
        "speeds": [k.pair.operating.pinion_speed], ("dte", "order", 1.0): [1.5e-6],
        ("dte", "order", 2.0): [0.4e-6],
    }  # fmt: skip


@row
def values_over_pinion_speed(k, folder):
    head = "speed [rpm], dte peak-to-peak [um], dte rms [um], H1 [um]\n"
    body = rows(k.speeds * 30 / PI, 1e6 * k.peak_to_peak, 1e6 * k.rms, 1e6 * k.first, delimiter=", ")
    return text(folder, "s.csv", head + body), {
        "speeds": k.speeds, ("dte", "peak_to_peak", 0.0): k.peak_to_peak, ("dte", "rms", 0.0): k.rms,
        ("dte", "order", 1.0): k.first,
    }  # fmt: skip


@row
def romax_values_over_gear_speed(k, folder):
    gear = k.speeds * k.pair.pinion.teeth / k.pair.gear.teeth
    head = "Output speed (rpm)\tTransmission error 1st harmonic (um)\tTE pk-pk (um)\n"
    body = rows(gear[::-1] * 30 / PI, 1e6 * k.first[::-1], 1e6 * k.peak_to_peak[::-1], delimiter="\t")
    return text(folder, "romax.txt", head + body), {
        "speeds": k.speeds, ("dte", "order", 1.0): k.first, ("dte", "peak_to_peak", 0.0): k.peak_to_peak,
    }  # fmt: skip


# ---- workbooks -------------------------------------------------------------------------------------------


def book(folder, lines, other_sheet=False):
    made = openpyxl.Workbook()
    if other_sheet:
        made.active.append(["Prüfstand 4, Lauf 12"])
        made.create_sheet("Daten")
    sheet = made.worksheets[-1]
    for line in lines:
        sheet.append(line)
    made.save(folder / "run.xlsx")
    return folder / "run.xlsx"


@row
def workbook_with_row_of_units(k, folder):
    data = np.column_stack([k.time, 1e6 * k.dte, k.bearing_force_y_p]).tolist()
    lines = [["Zeit", "DTE", "Lagerkraft y Ritzel"], ["s", "µm", "N"], *data]
    return book(folder, lines, other_sheet=True), {
        "places": k.time, "dte": k.dte, "bearing_force_y_p": k.bearing_force_y_p, "remark": "sheet Daten",
    }  # fmt: skip


@row
def workbook_with_numbers_as_german_text(k, folder):
    cells = [[f"{t:.9e}".replace(".", ","), f"{1e6 * d:.9e}".replace(".", ",")] for t, d in zip(
        k.time, k.dte, strict=True)]  # fmt: skip
    return book(folder, [["Zeit [s]", "Drehfehler [µm]"], *cells]), {"places": k.time, "dte": k.dte}


@row
def old_workbook(k, folder):
    return text(folder, "run.xls", "x"), "Save the sheet as .xlsx or .csv"


# ---- MATLAB and Simulink ---------------------------------------------------------------------------------


def mat(folder, **content):
    scipy.io.savemat(folder / "out.mat", content)
    return folder / "out.mat"


@row
def matlab_row_vectors(k, folder):
    return mat(folder, t=k.time[None], DTE=k.dte[None], theta_p=k.theta_p[:, None]), {
        "places": k.time, "dte": k.dte, "theta_p": k.theta_p,
    }  # fmt: skip


@row
def matlab_structure(k, folder):
    return mat(folder, sim={"t": k.time, "pinion": {"x": k.x_p}, "gear": {"x": k.x_g}, "note": "run"}), {
        "places": k.time, "x_p": k.x_p, "x_g": k.x_g,
    }  # fmt: skip


@row
def simulink_structure_with_time(k, folder):
    kind = [("values", object), ("dimensions", object), ("label", object), ("blockName", object)]
    signals = np.zeros((1, 2), dtype=kind)
    signals[0, 0] = (k.dte[:, None], 1.0, "dte", "stage/Scope")
    signals[0, 1] = (np.column_stack([k.x_p, k.y_p]), 2.0, "x_p, y_p", "stage/Mux")
    return mat(folder, ScopeData={"time": k.time[:, None], "signals": signals, "blockName": "stage/Scope"}), {
        "places": k.time, "dte": k.dte, "x_p": k.x_p, "y_p": k.y_p,
    }  # fmt: skip


@row
def matlab_time_series_as_structure(k, folder):
    return mat(folder, dte={"Name": "dte", "Time": k.time, "Data": k.dte}), {"places": k.time, "dte": k.dte}


def hdf5(folder, kind, **arrays):
    with h5py.File(folder / "out.mat", "w", userblock_size=512) as file:
        for name, values in arrays.items():
            made = file.create_dataset(name, data=np.atleast_2d(values))
            made.attrs["MATLAB_class"] = np.bytes_(kind)
    with (folder / "out.mat").open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return folder / "out.mat"


@row
def matlab_version_73(k, folder):
    mass = np.array([[2.0, 0.3], [0.1, 1.0]])  # HDF5 of MATLAB is transposed
    return hdf5(folder, "double", t=k.time, dte=k.dte, M=mass.T), {
        "places": k.time, "dte": k.dte, "statics": {"M": mass},
    }  # fmt: skip


@row
def matlab_time_series_object(k, folder):
    return hdf5(folder, "timeseries", out=[[1, 2]]), "t = ts.Time; dte = ts.Data"


@row
def repeated_times_of_simulink(k, folder):
    again = np.sort(np.append(np.arange(k.time.size), [40, 41]))
    values = k.dte[again].copy()
    values[40] += 1e-6  # before the jump; the later sample counts
    return mat(folder, tout=k.time[again], dte=values), {
        "places": k.time, "dte": k.dte, "remark": "2 samples at a repeated time are left out",
    }  # fmt: skip


# ---- objects ---------------------------------------------------------------------------------------------


@row
def data_frame_with_index(k, folder):
    frame = pd.DataFrame({"TE [um]": 1e6 * k.dte, "Fbx1 [N]": k.bearing_force_x_p})
    return frame.set_index(pd.Index(1e3 * k.time, name="time [ms]")), {
        "places": k.time, "dte": k.dte, "bearing_force_x_p": k.bearing_force_x_p,
    }  # fmt: skip


@row
def data_frame_with_time_deltas(k, folder):
    steps = pd.to_timedelta(np.arange(k.time.size), unit="us")
    return pd.DataFrame({"dte": k.dte}, index=steps), {"places": 1e-6 * np.arange(k.time.size), "dte": k.dte}


@row
def dataset_with_units(k, folder):
    return xr.Dataset(
        {"te": ("time", 1e6 * k.dte, {"units": "um"}), "x1": ("time", k.x_p, {"units": "m"})},
        coords={"time": ("time", 1e3 * k.time, {"units": "ms"})},
    ), {"places": k.time, "dte": k.dte, "x_p": k.x_p}


@row
def netcdf(k, folder):
    data, expected = dataset_with_units(k, folder)
    data.to_netcdf(folder / "x.nc", engine="h5netcdf")
    return folder / "x.nc", expected


@row
def classic_netcdf(k, folder):
    data, expected = dataset_with_units(k, folder)
    data.to_netcdf(folder / "x.nc", engine="scipy", format="NETCDF3_CLASSIC")
    return folder / "x.nc", expected


@row
def numpy_archive(k, folder):
    np.savez(folder / "x.npz", time=k.time, dte=k.dte, pinion_torque=56.5)
    return folder / "x.npz", {"places": k.time, "dte": k.dte, "torque": 56.5}


@row
def record_array(k, folder):
    return np.rec.fromarrays([k.time, k.x_g], names="t,x2"), {"places": k.time, "x_g": k.x_g}


@row
def mapping_with_facts(k, folder):
    return {
        "time": k.time, "dte": k.dte, "contact_ratio": 1.46, "base_radius_pinion [mm]": 35.9,
        "natural_frequencies [kHz]": [1.0, 2.5], "M": np.eye(2), "pinion_speed [rpm]": 4875.0,
        "role": "measurement",
    }, {
        "dte": k.dte, "speed": 4875.0 * PI / 30, "role": "measurement",
        "statics": {"contact_ratio": 1.46, "base_radius_pinion": 0.0359,
                    "natural_frequencies": [1000.0, 2500.0], "M": np.eye(2)},
    }  # fmt: skip


# ---- refusals that say what to type ----------------------------------------------------------------------


@row
def unit_of_another_kind(k, folder):
    return text(
        folder, "u.csv", "time [s],dte [N]\n" + rows(k.time, k.dte)
    ), "dte [N]: unit = N: allowed a unit of m"


@row
def two_columns_of_one_quantity(k, folder):
    return {"time": k.time, "TE": k.dte, "dte": k.dte}, "TE and dte: allowed one column of dte"


@row
def speed_without_unit(k, folder):
    return {"speed": k.speeds, "dte rms": k.rms}, r"Write 'speed \[rpm\]' or 'speed \[rad/s\]'"


@row
def no_abscissa(k, folder):
    return {"dte": k.dte, "x_p": k.x_p}, r"a column with one of time \[s\]"


@row
def misspelt_heading(k, folder):
    return {"time": k.time, "mesh_fource": k.dte}, "Did you mean 'mesh_force'"


@row
def separators_of_thousands(k, folder):
    lines = [f"{t:.6f}\t1.{300 + n:03d},5" for n, t in enumerate(k.time)]
    return text(folder, "t.txt", "t [s]\tFm [N]\n" + "\n".join(lines)), "without separators of thousands"


@row
def bare_harmonics_of_two_quantities(k, folder):
    return {"speed [rpm]": k.speeds, "dte rms": k.rms, "x_p rms": k.rms, "H1": k.first}, "such as 'dte H1'"


@row
def angles_of_dates(k, folder):
    days = [datetime.date(2026, 1, 1)] * k.time.size
    return pd.DataFrame({"time": days, "dte": k.dte}), "Convert the column"


@row
def simulink_model(k, folder):
    return text(folder, "stage.slx", "x"), "Run the model, and save its signals"


@row
def no_source(k, folder):
    return 3.0, r"Write \{'time': t, 'dte': dte\}"


def known(name):
    """Motion of the row; one in two on another pair."""
    return Known(OTHER) if sorted(ROWS).index(name) % 2 else Known()
