

def test_readings_win_over_a_stated_drive_that_they_contradict():
    table = ieap.simulate(PARAMETERS, drive=[(0, 1.5)], **STRIP, until_s=200, every_s=1, noise=NOISE)
    columns = {name: table.column(name) for name in ("time_s", "voltage_v", "current_a", "curvature_per_cm")}
    fit = ieap.fit(columns, drive=[(0.0, 3.0)], **STRIP)
    assert "drive-contradicted" in {issue["code"] for issue in fit.issues}
    assert abs(fit["r2_ohm_cm2"].value / PARAMETERS["r2_ohm_cm2"] - 1) < 0.05
