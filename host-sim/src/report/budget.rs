//! The error budget as a table.

use super::number::{decimals_for, fixed, significant};
use super::svg::escape;
use crate::replay::budget::{BudgetLine, BudgetShare};
use crate::replay::result::{CoefficientSummary, ReplayResult};
use crate::rounding::{own_digits, part_of};

/// Input, value, standard deviation, and effect on both coefficients; empty before the first event.
pub(super) fn budget(result: &ReplayResult) -> String {
    if result.budget.is_empty() {
        return String::new();
    }
    let means = [&result.estimate.mu_s, &result.estimate.mu];
    let mut rows = String::new();
    for line in result.budget.iter().map(BudgetLine::printed) {
        let shares = [&line.mu_s, &line.mu].into_iter().zip(means);
        let shares: String = shares.map(|(share, mean)| cells(share, mean)).collect();
        rows.push_str(&format!(
            "<tr><th scope=\"row\">{}{}</th><td class=\"more\">{}</td><td class=\"more\">{}</td>\
             {shares}</tr>\n",
            name(line.input),
            line.remark().map_or_else(String::new, |it| format!(" <small>{it}</small>")),
            number(line.value),
            line.std.map_or("–".into(), |std| fixed(std, decimals_for(std, 2))),
        ));
    }
    let random: String = means
        .iter()
        .map(|mean| cells(&BudgetShare { sensitivity: None, contribution: mean.std_error }, mean))
        .collect();
    let head = |coefficient: &str| {
        format!(
            "<th scope=\"col\" class=\"more\">{coefficient} per unit</th><th scope=\"col\">± of \
             {coefficient}</th><th scope=\"col\">share</th>"
        )
    };
    let (mu_s, mu) = (head("<i>μ</i><sub>s</sub>"), head("<i>μ</i>"));
    format!(
        "<h2>What limits the result</h2><div class=\"scroll budget\" tabindex=\"0\" role=\"region\" \
         aria-label=\"Error budget\"><table><thead><tr><th scope=\"col\">input</th>\
         <th scope=\"col\" class=\"more\">value</th><th scope=\"col\" class=\"more\">± of it</th>\
         {mu_s}{mu}</tr></thead>\
         <tbody>\n{rows}<tr><th scope=\"row\">random: noise and variation between events</th>\
         <td class=\"more\">–</td><td class=\"more\">–</td>{random}</tr></tbody></table></div><p>All are \
         one standard deviation; only the random part gets smaller with more events.</p>"
    )
}

/// Sensitivity, contribution, share of the combined variance.
fn cells(share: &BudgetShare, mean: &CoefficientSummary) -> String {
    let part = share.contribution.zip(mean.combined_std).filter(|(_, all)| *all > 0.0);
    let part = part.map_or("–".into(), |(own, all)| fixed(100.0 * (own / all).powi(2), 1) + " %");
    let own = match (share.contribution, mean.combined_std) {
        (Some(own), Some(whole)) => escape(&part_of(own, whole)),
        (Some(own), None) => own_digits(own),
        (None, _) => "–".into(),
    };
    format!("<td class=\"more\">{}</td><td>{own}</td><td>{part}</td>", number(share.sensitivity))
}

fn number(value: Option<f64>) -> String {
    value.map_or("–".into(), significant)
}

fn name(input: &str) -> &str {
    match input {
        "weight_n" => "weight, N",
        "slope_rad" => "slope, rad",
        "zero_n" => "zero as taken, N",
        "span" => "span, a factor",
        "damping" => "damping, of the critical one",
        "winch_m_per_s" => "winch speed, m/s",
        "zero_drift_n" => "zero moved during the test, N",
        "weight_ratio" => "weight over the given one",
        "shared" => "what the events share",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn shares_are_of_the_combined_variance() {
        let mut result = SampleLog::dff8_13(60.0).result;
        assert_eq!(budget(&result), "");
        let combined = result.estimate.mu.combined_std.unwrap();
        let half = BudgetShare { sensitivity: Some(-0.002), contribution: Some(combined / 2.0) };
        result.budget.push(BudgetLine {
            input: "weight_n",
            value: Some(630.0),
            std: Some(1.9),
            stated_std: Some(1.0),
            is_unmeasured: false,
            mu_s: BudgetShare::default(),
            mu: half,
        });
        let table = budget(&result);
        assert!(table.contains("weight, N") && table.contains("25.0 %"), "{table}");
        assert!(table.contains("<small>stated 1.0, widened by what the slips show</small>"));
        result.budget[0].is_unmeasured = true;
        let table = budget(&result);
        let row = table.lines().find(|row| row.contains("weight, N")).unwrap();
        assert!(row.contains("<small>not measured, and none is seen: "), "{row}");
        assert!(!row.contains("25.0 %") && !row.contains("1.9"), "{row}");
    }
}
