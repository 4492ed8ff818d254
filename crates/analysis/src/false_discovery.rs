//! What may be claimed where many groups are asked at once: q-values (Benjamini and Hochberg 1995).

use ieap_domain::finding_words::{About, say};
use ieap_domain::{GroupDiagnosis, Verdict};

/// At most this part of what is claimed over a campaign is expected to be false.
pub const CLAIMED_BELOW: f64 = 0.05;

/// For each p the smallest rate of false discoveries at which it would be among those claimed.
pub fn q_values(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut q = vec![1.0; p.len()];
    let mut smallest: f64 = 1.0;
    for (rank, &index) in order.iter().enumerate().rev() {
        // Rounding must not bring a q below its p.
        let own = (p[index] * p.len() as f64 / (rank + 1) as f64).max(p[index]);
        smallest = smallest.min(own);
        q[index] = smallest;
    }
    q
}

/// For each p the chance that what it is of differs, where nothing is known before: as likely as not nothing differs at all;
/// else any part of all does, and chances of what does pile up at zero as any power of them. Where nothing stands out the first
/// is left, so that the likeliest of many is not taken for what chance brings.
pub fn chances_of_difference(p: &[f64]) -> Vec<f64> {
    /// Parts, and powers, that are tried. Chosen: with 40 each, of 193 chances of answers with p from 0.001 to 0.05 one differs by
    /// 0.036, the others by less, and none crosses 0.8.
    const TRIED: usize = 20;
    /// Chances below are as good as none.
    const LEAST_P: f64 = 1e-12;
    let place = |k: usize| (k as f64 + 0.5) / TRIED as f64;
    let logs: Vec<f64> = p.iter().map(|p| p.clamp(LEAST_P, 1.0).ln()).collect();
    let tried = (0..TRIED * TRIED).map(|k| (place(k / TRIED), place(k % TRIED)));
    // By part and power: how likely that makes all, and the chance of each.
    let worlds: Vec<(f64, Vec<f64>)> = tried
        .map(|(part, power)| {
            let differs = |log: &f64| part * power * ((power - 1.0) * log).exp();
            let each = logs.iter().map(|log| (differs(log), 1.0 - part));
            let likely = each.clone().map(|(differs, none)| (differs + none).ln()).sum();
            (
                likely,
                each.map(|(differs, none)| differs / (differs + none)).collect(),
            )
        })
        .collect();
    // That nothing differs makes all of them even.
    let most = worlds.iter().map(|(likely, _)| *likely).fold(0.0, f64::max);
    let nothing = worlds.len() as f64 * (-most).exp();
    let weights: Vec<f64> = worlds.iter().map(|(likely, _)| (likely - most).exp()).collect();
    let all = nothing + weights.iter().sum::<f64>();
    let of = |k: usize| {
        let own = weights
            .iter()
            .zip(&worlds)
            .map(|(weight, (_, each))| weight * each[k]);
        own.sum::<f64>() / all
    };
    (0..p.len()).map(of).collect()
}

/// Fills in the q of every misfit and of every effect over `found`, takes back what they do not carry, and says what is left.
///
/// The effects of a group are part of one family with those of all others; a group without an effect counts there
/// with p = 1, for it was asked as well.
pub fn judge_together(found: &mut [GroupDiagnosis], about: &About) {
    let asked: Vec<usize> = (0..found.len())
        .filter(|&k| found[k].p_misfit.is_some())
        .collect();
    let p: Vec<f64> = asked.iter().filter_map(|&k| found[k].p_misfit).collect();
    for (&k, q) in asked.iter().zip(q_values(&p)) {
        found[k].q_misfit = Some(q);
    }
    let mut places = Vec::new();
    let mut p = Vec::new();
    for &k in &asked {
        if found[k].effects.is_empty() {
            places.push(None);
            p.push(1.0);
        }
        for (place, effect) in found[k].effects.iter().enumerate() {
            places.push(Some((k, place)));
            p.push(effect.p);
        }
    }
    for (place, q) in places.iter().zip(q_values(&p)) {
        if let Some((k, place)) = *place {
            found[k].effects[place].q = Some(q);
        }
    }
    for one in found {
        take_back(one);
        say(one, about);
    }
}

/// A finding that as many groups would show by chance is not claimed.
fn take_back(one: &mut GroupDiagnosis) {
    let wrong = one.verdict.is_misfit();
    let too_much = |q: Option<f64>| q.is_some_and(|q| q > CLAIMED_BELOW);
    if !wrong || !(too_much(one.q_misfit) || one.effects.iter().any(|effect| too_much(effect.q))) {
        return;
    }
    one.verdict = Verdict::Undecided;
    one.effects.clear();
    one.set.clear();
    one.missing.clear();
    one.next_run = None;
    one.shifts.clear();
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use ieap_domain::testing::{self, finding, missing_law, shift};
    use ieap_domain::{EffectFinding, NextRun};

    fn group(verdict: Verdict, p: f64, effect_p: Option<f64>) -> GroupDiagnosis {
        let effect = |p| EffectFinding {
            p,
            ..testing::effect("faradaic-leak", Vec::new())
        };
        GroupDiagnosis {
            verdict,
            p_misfit: Some(p),
            effects: effect_p.map(effect).into_iter().collect(),
            set: effect_p.map(|_| "faradaic-leak".to_owned()).into_iter().collect(),
            ..finding()
        }
    }

    #[test]
    fn q_of_the_worked_example_of_benjamini_and_hochberg() {
        // Their table of 15 p-values: four are claimed at 5 %.
        let p = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719,
            0.6528, 0.7590, 1.0,
        ];
        let q = q_values(&p);
        assert_eq!(q.iter().filter(|q| **q <= 0.05).count(), 4);
        assert!((q[0] - 0.0015).abs() < 1e-12 && (q[3] - 0.035625).abs() < 1e-12);
    }

    #[test]
    fn a_finding_that_chance_would_bring_is_taken_back() {
        let mut found = vec![group(Verdict::Right, 0.5, None); 30];
        found.push(group(Verdict::Law, 0.008, Some(0.008)));
        judge_together(&mut found, &|_| None);
        let last = &found[30];
        assert_eq!(
            (last.verdict, last.effects.len(), last.set.len()),
            (Verdict::Undecided, 0, 0)
        );
        assert!(last.sentence.contains("too often"), "{}", last.sentence);
    }

    #[test]
    fn what_is_taken_back_claims_nothing_anywhere() {
        let claimed = GroupDiagnosis {
            missing: vec![missing_law(Some("faradaic-leak"), "5 of 5")],
            next_run: Some(NextRun {
                drive: "reverse the voltage for 600 s".to_owned(),
                splits: vec!["faradaic-leak".to_owned(), "creep".to_owned()],
                expected_set_size: 1.0,
            }),
            shifts: vec![shift("rss_ohm_cm2", 1.0, 2.0, 0.1)],
            ..group(Verdict::Law, 0.008, Some(0.008))
        };
        let mut kept = [claimed.clone()];
        judge_together(&mut kept, &|_| None);
        assert_eq!((kept[0].next_run.is_some(), kept[0].shifts.len()), (true, 1));
        assert_eq!(kept[0].missing.len(), 1);

        let mut found = vec![group(Verdict::Right, 0.5, None); 30];
        found.push(claimed);
        judge_together(&mut found, &|_| None);
        let last = &found[30];
        assert_eq!((&last.next_run, last.shifts.len()), (&None, 0));
        assert!(last.missing.is_empty());
    }

    #[test]
    fn a_finding_that_its_q_carries_stays() {
        let mut found = vec![group(Verdict::Right, 0.5, None); 9];
        found.push(group(Verdict::Law, 0.001, Some(0.001)));
        judge_together(&mut found, &|_| None);
        assert_eq!(found[9].verdict, Verdict::Law);
        assert!((found[9].effects[0].q.unwrap() - 0.01).abs() < 1e-12);
    }

    #[test]
    fn the_likeliest_of_many_is_not_likely_and_beside_what_is_sure_it_is() {
        let even: Vec<f64> = (1..20).map(|k| f64::from(k) / 20.0).collect();
        let chance = |mut p: Vec<f64>, own: f64| {
            p.push(own);
            chances_of_difference(&p)[p.len() - 1]
        };
        assert!(chance(even.clone(), 0.03) < 0.3, "{}", chance(even.clone(), 0.03));
        assert!(chance(even.clone(), 1e-6) > 0.95);
        let sure = [even[..5].to_vec(), vec![1e-6; 10]].concat();
        assert!(chance(sure.clone(), 0.01) > 0.8, "{}", chance(sure, 0.01));
        assert!(chances_of_difference(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn q_is_at_least_p_and_keeps_the_order(p in prop::collection::vec(0.0..=1.0_f64, 1..60)) {
            let q = q_values(&p);
            for (a, &pa) in p.iter().enumerate() {
                prop_assert!(q[a] >= pa && q[a] <= 1.0);
                for (b, &pb) in p.iter().enumerate() {
                    prop_assert!(pa > pb || q[a] <= q[b]);
                }
            }
        }
    }
}
