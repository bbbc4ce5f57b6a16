use super::*;

#[test]
fn known_keys_are_kept_and_the_rest_skipped() {
    let mut metadata = Metadata::default();
    let lines = ["# weight_n: 630", "#slope_deg:-2,5", "# test_id: DFF8-13", "# note: hi", "#"];
    for (number, line) in (1..).zip(lines) {
        metadata.take(line.as_bytes(), number).unwrap();
    }
    let said = [("weight_n", "630", 1), ("slope_deg", "-2,5", 2), ("test_id", "DFF8-13", 3)];
    let said = said.map(|(key, value, line)| {
        let (key, value) = (key.to_string(), value.to_string());
        Said { key, value, line }
    });
    let expected = Metadata {
        weight_n: Some(630.0),
        slope_deg: Some(-2.5),
        test_id: Some("DFF8-13".to_string()),
        said: said.to_vec(),
        ..Metadata::default()
    };
    assert_eq!(metadata, expected);
}

#[test]
fn a_value_that_is_no_number_is_an_error() {
    let error = Metadata::default().take(b"# weight_n: heavy", 1).unwrap_err();
    assert_eq!(error.to_string(), "'# weight_n:' has 'heavy': write the number alone");
    assert!(Metadata::default().take(b"# rate_hz: nan", 1).is_err());
}

#[test]
fn what_cannot_be_is_refused() {
    let refused =
        |line: &str| Metadata::default().take(line.as_bytes(), 1).unwrap_err().to_string();
    assert!(refused("# snow_mm: -4").starts_with("'# snow_mm:' has '-4': write the depth"));
    assert!(refused("# cable_length_m: -1").contains("above zero"));
    assert!(refused("# kind: foo").contains("write one of sliding, rafting, over-riding"));
    let mut metadata = Metadata::default();
    metadata.take(b"# kind: Rafting", 1).unwrap();
    assert_eq!(metadata.kind.as_deref(), Some("rafting"));
}

#[test]
fn weight_and_mass_agree_or_both_lines_are_named() {
    let mut metadata = Metadata::default();
    metadata.take(b"# weight_n: 630", 2).unwrap();
    metadata.take(b"# mass_kg: 64.2", 3).unwrap();
    let mut metadata = Metadata::default();
    metadata.take(b"# mass_kg: 100", 2).unwrap();
    let error = metadata.take(b"# weight_n: 630", 7).unwrap_err().to_string();
    let both =
        "'# weight_n: 630' in line 7 is not the weight of '# mass_kg: 100' in line 2, 980.7 N";
    assert!(error.starts_with(both), "{error}");
}

#[test]
fn what_was_meant_for_a_key_is_noted() {
    let mut metadata = Metadata::default();
    let lines = [
        "# weight_kn: 0.63",
        "# weight_n=630",
        "# Mass: 64 kg",
        "# zero_n: 3.5",
        "# weighed: twice",
    ];
    for (number, line) in (1..).zip(lines) {
        metadata.take(line.as_bytes(), number).unwrap();
    }
    assert_eq!(
        metadata.notes[0].text,
        "line 1: 'weight_kn: 0.63' is not read: write '# weight_n: 630'"
    );
    assert_eq!(
        metadata.notes[3].text,
        "line 4: 'zero_n: 3.5' is not read: write '# zero_before_n: 1.2'"
    );
    assert_eq!(metadata.notes.len(), 4);
    metadata.take(b"% weight_n: 630", 9).unwrap();
    metadata.take(b"\"# slope_deg: 5\",;", 10).unwrap();
    assert_eq!((metadata.weight_n, metadata.slope_deg), (Some(630.0), Some(5.0)));
}

#[test]
fn what_comes_too_late_is_said_and_not_used() {
    let mut metadata = Metadata::default();
    metadata.take(b"# weight_n: 630", 2).unwrap();
    for (line, number) in [("# weight_n: 630", 9), ("# slope_deg: 5", 10), ("# slope_deg: 6", 11)] {
        metadata.take_late(line.as_bytes(), number).unwrap();
    }
    assert_eq!((metadata.slope_deg, metadata.said.len()), (None, 1));
    let late = "line 10: '# slope_deg: 5' comes too late and is not used: write it above the rows";
    let (key, text) = ("slope_deg".to_string(), late.to_string());
    assert_eq!(metadata.notes, [Note { key, text }]);
    assert!(metadata.take_late(b"# weight_n: 700", 12).is_err());
}

#[test]
fn an_option_settles_what_the_log_contradicts() {
    let mut metadata = Metadata::new(&["weight_n", "mass_kg"]);
    for (line, number) in [("# weight_n: 630", 2), ("# weight_n: 700", 3), ("# weight_n: 800", 4)] {
        metadata.take(line.as_bytes(), number).unwrap();
    }
    metadata.take(b"# mass_kg: 100", 5).unwrap();
    let text = "line 3: '# weight_n:' says '700', and line 2 says otherwise: neither is used, as \
                the command says it";
    assert_eq!(metadata.notes, [Note { key: "weight_n".into(), text: text.into() }]);
    assert!(metadata.is_contradicted("weight_n") && !metadata.is_contradicted("mass_kg"));
    metadata.take(b"# slope_deg: 1", 6).unwrap();
    assert!(metadata.take(b"# slope_deg: 2", 7).is_err());
    metadata.take_late(b"# mass_kg: 90", 20).unwrap();
    assert_eq!((metadata.notes.len(), metadata.is_contradicted("mass_kg")), (2, true));
}

#[test]
fn a_value_may_be_repeated_and_not_changed() {
    let mut metadata = Metadata::default();
    metadata.take(b"# weight_n: 630", 2).unwrap();
    metadata.take(b"# weight_n: 630.0", 7).unwrap();
    let error = metadata.take(b"# weight_n: 700", 9).unwrap_err().to_string();
    assert!(error.starts_with("'# weight_n:' says '700', and line 2 says otherwise"), "{error}");
}

#[test]
fn a_line_that_comes_again_and_again_is_noted_a_few_times() {
    let mut metadata = Metadata::default();
    for number in 1..9999 {
        metadata.take_late(b"# weight: 630", number).unwrap();
    }
    assert_eq!(metadata.notes.len(), 8);
    assert!(metadata.notes[7].text.starts_with("line 8: "));
}
