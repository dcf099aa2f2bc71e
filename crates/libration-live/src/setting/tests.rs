use super::*;

const TEXT: &str = "system=mine\ncoordinates=x\ninputs=u\nacceleration.x=-k*x + u\nparameter.k=10.0\nstart.x=1.0\n\
                    integrator=rk4\ndt=0.01\nhorizon=10.0\ngain=10.0,2.0\ngain-factor=1.0\nperiod=0.02\nlatency=0.03\n\
                    jitter=0.1\nskew=-0.01\nloss=0.0\nseed=7\n";

#[test]
fn a_setting_is_the_text_that_it_was_read_from() {
    assert_eq!(TEXT.parse::<Setting>().unwrap().to_string(), TEXT);
}

#[test]
fn an_error_names_key_value_and_what_is_allowed() {
    for (line, message) in [
        ("dt=0", "dt = 0; expected seconds above 0"),
        ("dt=nan", "dt = nan; expected seconds above 0"),
        ("jitter=0.5", "jitter = 0.5; expected a part of the period from 0 to 1/3"),
        ("gain=1,b", "gain = 1,b; expected rows of numbers, such as 10,2;0,1"),
        ("integrator=rk5", "integrator = rk5; expected a name of `libration list`"),
        ("parameter.k=x", "parameter.k = x; expected a number"),
        ("colour=red", "unknown key `colour`"),
        ("parameters.k=1", "unknown key `parameters.k`"),
        ("what", "`what` is no entry; expected KEY=VALUE"),
    ] {
        assert_eq!(line.parse::<Setting>().unwrap_err().to_string(), message);
    }
}

#[test]
fn a_later_entry_replaces_an_earlier_one() {
    let setting: Setting = format!("{TEXT}parameter.k=3\nstart.x=2").parse().unwrap();
    assert_eq!(setting.definitions.parameters, [("k".to_owned(), 3.0)]);
    assert_eq!(setting.start, [("x".to_owned(), 2.0)]);
}
