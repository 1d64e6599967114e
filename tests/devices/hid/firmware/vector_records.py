"""What stands in the test vectors: typical reports and pages by hand, and for each kind the rules between fields."""

ONE = 2**30
HALF = 2**29

TYPICAL = {
    "command": {
        "mode": 1, "touching": 1, "sequence": 4711, "contact_point_nm": [1200000, -340000, 560000],
        "normal": [186447862, -93223931, 1053350000], "penetration_nm": 2350000, "penetration_rate_um_per_s": -48250,
        "stiffness_mn_per_m": 700000, "most_force_un": 1645000, "damping_cn_s_per_m": 150, "roll_dmrad": 1745,
        "pitch_dmrad": -873, "vibration_mg": 867, "vibration_dhz": 1500,
    },
    "telemetry": {
        "state": 1, "buttons": 5, "sequence": 305419896, "command_sequence": 4710, "time_us": 98765432109,
        "joint_urad": [612345, -598765, 605432], "force_un": 1612345, "height_nm": -18392345, "roll_dmrad": 1739,
        "pitch_dmrad": -871, "yaw_dmrad": -37, "vibration_mg": 866, "faults": 0, "limits": 258, "rejected": 3,
        "command_age_us": 412, "temperature_cdeg": 3412, "battery_percent": 87,
    },
    "pose": {
        "finger": 2, "seen": 1, "has_flexion": 1, "sequence": 90210, "time_us": 1234567890123,
        "position_nm": [65432100, -1234567, 98765432], "orientation": [982439, 314159265, -271828182, 989000000],
        "flexion_urad": 523599,
    },
    "request": {"operation": 1, "page": 3, "token": 3735928559, "data": [(7 * i + 3) % 256 for i in range(52)]},
    "answer": {"result": 0, "page": 2, "token": 305441741, "data": [(255 - 5 * i) % 256 for i in range(52)]},
    "identity": {
        "lowest_version": 1, "highest_version": 1, "model": 1, "finger": 2, "degrees_of_freedom": 3,
        "firmware": [1, 4, 12], "loop_rate_hz": 1000, "capabilities": 111, "serial": "JND-0001",
        "calibration_id": "0123456789abcdef", "calibration_date": 20260301, "watchdog_ms": 20,
    },
    "limits": {
        "most_force_un": 4700000, "most_stiffness_mn_per_m": 2000000, "most_force_rise_mn_per_s": 500000,
        "lowest_height_nm": -27500000, "highest_height_nm": -12500000, "most_roll_dmrad": 6283,
        "most_pitch_dmrad": 5236, "most_joint_speed_mrad_per_s": 10472, "least_vibration_mg": 50,
        "most_vibration_mg": 1000, "least_vibration_dhz": 500, "most_vibration_dhz": 2400, "most_burst_ms": 200,
        "most_damping_cn_s_per_m": 1000, "most_temperature_cdeg": 5500, "soft_start_ms": 200,
    },
    "geometry": {
        "a_nm": 6000000, "b_nm": 10000000, "bh_nm": 5000000, "bd_nm": 17320508, "l1_nm": 12000000, "l2_nm": 20000000,
        "rest_height_nm": -20000000,
    },
    "force_table": {
        "points": 4, "sensor_un": [-12000, 980000, 2010000, 4650000, 0, 0],
        "force_un": [0, 1000000, 2000000, 4700000, 0, 0],
    },
    "certificate": {"calibration_id": "fedcba9876543210", "date": 20261122},
}

# Other right ones, as changes to the typical one. NAME: changes.
OTHERS = {
    "command": {
        "first": {"mode": 0, "touching": 0, "sequence": 1, "contact_point_nm": [0, 0, 0], "normal": [0, 0, 0],
                  "penetration_nm": 0, "penetration_rate_um_per_s": 0, "stiffness_mn_per_m": 0, "most_force_un": 0,
                  "damping_cn_s_per_m": 0, "roll_dmrad": 0, "pitch_dmrad": 0, "vibration_mg": 0, "vibration_dhz": 0},
        "before_wrap": {"sequence": 2**32 - 1}, "after_wrap": {"sequence": 0}, "half_way": {"sequence": 2**31},
        "straight": {"normal": [0, 0, ONE]}, "pulls": {"normal": [0, 0, -ONE]}, "sideways": {"normal": [ONE, 0, 0]},
    },
    "telemetry": {
        "first": {"state": 0, "sequence": 1, "command_sequence": 0, "time_us": 0, "command_age_us": 65535, "limits": 0},
        "before_wrap": {"sequence": 2**32 - 1, "command_sequence": 2**32 - 1, "rejected": 65535},
        "after_wrap": {"sequence": 0, "command_sequence": 0, "rejected": 0},
        "older_than_32_bits": {"time_us": 2**32}, "no_thermometer": {"temperature_cdeg": -32768},
        "on_the_cable": {"battery_percent": 255}, "stopped": {"state": 2, "faults": 1, "force_un": 0, "limits": 0},
        "pulled": {"force_un": -1}, "all_faults": {"state": 2, "faults": 127}, "all_limits": {"limits": 511},
    },
    "pose": {
        "before_wrap": {"sequence": 2**32 - 1}, "after_wrap": {"sequence": 0},
        "without_flexion": {"has_flexion": 0, "flexion_urad": 0},
        "unseen": {"seen": 0, "has_flexion": 0, "position_nm": [0, 0, 0], "orientation": [0, 0, 0, 0], "flexion_urad": 0},
        "by_w": {"orientation": [ONE, 0, 0, 0]}, "by_x": {"orientation": [0, ONE, 0, 0]},
        "by_y": {"orientation": [0, 0, ONE, 0]}, "by_z": {"orientation": [0, 0, 0, ONE]},
        "by_minus_w": {"orientation": [-ONE, 0, 0, 0]}, "by_minus_x": {"orientation": [0, -ONE, 0, 0]},
        "by_minus_y": {"orientation": [0, 0, -ONE, 0]}, "by_minus_z": {"orientation": [0, 0, 0, -ONE]},
        "halves": {"orientation": [HALF, -HALF, HALF, -HALF]},
        "a_little_long": {"orientation": [round(ONE * 1.00094), 0, 0, 0]},
        "a_little_short": {"orientation": [0, 0, 0, round(ONE * 0.99906)]},
    },
    "request": {
        "of_identity": {"operation": 0, "page": 0, "token": 1, "data": [0] * 52},
        "of_certificate": {"operation": 0, "page": 4, "token": 2, "data": [0] * 52},
    },
    "answer": {
        "unknown": {"result": 1, "page": 255, "data": [0] * 52},
        "refused": {"result": 2, "page": 1, "data": [0] * 52},
        "invalid": {"result": 3, "page": 3, "data": [0] * 52},
    },
    "identity": {
        "of_a_tracker": {"model": 2, "finger": 0, "degrees_of_freedom": 6, "loop_rate_hz": 240, "capabilities": 16,
                         "serial": "T", "calibration_id": "", "calibration_date": 0, "watchdog_ms": 0},
        "of_another_version": {"lowest_version": 9, "highest_version": 9},
        "full_texts": {"serial": "!#$%&'()*+,-./:;", "calibration_id": "<=>?@[]^_`{|}~AZ"},
        "first_day": {"calibration_date": 20000101}, "last_day": {"calibration_date": 99991231},
    },
    "limits": {
        "of_one_value": {"lowest_height_nm": -1, "highest_height_nm": -1, "least_vibration_mg": 7,
                         "most_vibration_mg": 7, "least_vibration_dhz": 9, "most_vibration_dhz": 9},
    },
    "geometry": {},
    "force_table": {
        "none": {"points": 0, "sensor_un": [0] * 6, "force_un": [0] * 6},
        "two": {"points": 2, "sensor_un": [0, 1, 0, 0, 0, 0], "force_un": [-1, 0, 0, 0, 0, 0]},
        "three": {"points": 3, "sensor_un": [-5, 0, 5, 0, 0, 0], "force_un": [1, 2, 3, 0, 0, 0]},
        "five": {"points": 5, "sensor_un": [1, 2, 3, 4, 5, 0], "force_un": [10, 20, 30, 40, 50, 0]},
        "six": {"points": 6, "sensor_un": [-(2**31), -1, 0, 1, 2, 2**31 - 1],
                "force_un": [-(2**31), -(2**30), -1, 0, 2**30, 2**31 - 1]},
    },
    "certificate": {"none": {"calibration_id": "", "date": 0}},
}

# Wrong by a rule between fields, or within a text or a date: changes to the typical one.
WRONG = {
    "pose": {
        "no_quaternion": {"orientation": [0, 0, 0, 0]}, "too_long": {"orientation": [round(ONE * 1.0011), 0, 0, 0]},
        "too_short": {"orientation": [0, 0, round(ONE * 0.9989), 0]},
        "far_too_long": {"orientation": [-(2**31), 2**31 - 1, -(2**31), 2**31 - 1]},
        "flexion_without_its_flag": {"has_flexion": 0}, "unseen_with_flexion": {"seen": 0},
        "unseen_with_all_but_flexion": {"seen": 0, "has_flexion": 0, "flexion_urad": 0},
        "unseen_with_flag": {"seen": 0, "position_nm": [0, 0, 0], "orientation": [0, 0, 0, 0], "flexion_urad": 0},
        "unseen_with_position": {"seen": 0, "has_flexion": 0, "position_nm": [0, 0, 1], "orientation": [0, 0, 0, 0],
                                 "flexion_urad": 0},
        "unseen_with_orientation": {"seen": 0, "has_flexion": 0, "position_nm": [0, 0, 0],
                                    "orientation": [ONE, 0, 0, 0], "flexion_urad": 0},
    },
    "identity": {
        "versions_swapped": {"lowest_version": 3, "highest_version": 2}, "no_serial": {"serial": ""},
        "serial_with_space": {"serial": "JND 0001"}, "serial_after_zero": {"serial": "JND\0X"},
        "serial_with_control": {"serial": "JND\n"}, "serial_with_del": {"serial": "JND\x7f"},
        "calibration_after_zero": {"calibration_id": "\0X"}, "calibration_with_space": {"calibration_id": "a b"},
        "month_0": {"calibration_date": 20260001}, "month_13": {"calibration_date": 20261301},
        "day_0": {"calibration_date": 20260300}, "day_32": {"calibration_date": 20260332},
        "year_1999": {"calibration_date": 19991231}, "year_10000": {"calibration_date": 100000101},
        "date_1": {"calibration_date": 1}, "date_highest": {"calibration_date": 2**32 - 1},
    },
    "limits": {
        "heights_swapped": {"lowest_height_nm": -12499999, "highest_height_nm": -12500000},
        "amplitudes_swapped": {"least_vibration_mg": 1001}, "frequencies_swapped": {"least_vibration_dhz": 2401},
    },
    "force_table": {
        "sensor_stands": {"sensor_un": [0, 980000, 980000, 4650000, 0, 0]},
        "sensor_falls": {"sensor_un": [0, 980000, 979999, 4650000, 0, 0]},
        "force_stands": {"force_un": [0, 1000000, 1000000, 4700000, 0, 0]},
        "force_falls": {"force_un": [0, 1000000, 2000000, 1999999, 0, 0]},
        "unused_sensor": {"sensor_un": [-12000, 980000, 2010000, 4650000, 1, 0]},
        "unused_force": {"force_un": [0, 1000000, 2000000, 4700000, 0, 1]},
        "none_with_a_point": {"points": 0},
        "seven": {"points": 7, "sensor_un": [1, 2, 3, 4, 5, 6], "force_un": [1, 2, 3, 4, 5, 6]},
    },
    "certificate": {
        "id_with_space": {"calibration_id": " "}, "id_after_zero": {"calibration_id": "a\0b"},
        "day_0": {"date": 20261100}, "month_13": {"date": 20261322}, "year_1999": {"date": 19991122},
    },
}


# The first of a pair is never above the second.
PAIRS = {
    "identity": [("lowest_version", "highest_version")],
    "limits": [("lowest_height_nm", "highest_height_nm"), ("least_vibration_mg", "most_vibration_mg"),
               ("least_vibration_dhz", "most_vibration_dhz")],
}


def settle(kind, record, changed):
    """Makes a record right again after its member `changed` was: the other one of its pair follows."""
    record = dict(record)
    for low, high in PAIRS.get(kind, []):
        if changed in (low, high) and record[low] > record[high]:
            record[high if changed == low else low] = record[changed]
    return record
