//! The runs that are diagnosed together, with their noise.

use std::ops::Range;
use std::sync::Arc;

use ieap_domain::{Drive, Quantity};
use ieap_fit::{EdgeTimes, FitInput, FitOptions, WhitenedChannel, aligned, without_outliers};
use ieap_model::effects::TagAt;
use ieap_model::extended::{ExtendedModel, Grids, RunContext};
use ieap_numerics::robust::median_step;
use ieap_numerics::sums;

use crate::readings::course::followed;
use crate::readings::left_open::LeftOpen;
use crate::readings::policy::{
    FEWEST_READINGS, GROWTH_EVIDENCE, GROWTHS, LONGEST_MEMORY_READINGS, MEMORY_BEYOND_USUAL, MOST_READINGS,
    SAME_STEP_FACTOR, SLOW_WORTH,
};
use crate::readings::scatter::{Scatter, left_open};

/// Step of the slope by an edge's time, in standard deviations of what is not known of it.
const SLOPE: f64 = 1e-2;

/// A run as it is given to a diagnosis.
#[derive(Debug, Clone, Copy)]
pub struct RunInput<'a> {
    /// Its name.
    pub name: &'a str,
    /// Channels, drive and area.
    pub input: FitInput<'a>,
    /// Free length of the sample, cm, where it is known.
    pub length_cm: Option<f64>,
    /// Whether a person looked at its readings and said that they are right.
    pub is_right: bool,
    /// Where it lies among the values of tags that differ in its group; of every run of a group the same tags.
    pub tags: &'a [TagAt],
}

/// A run with its readings and noise.
#[derive(Debug, Clone)]
pub(crate) struct GroupRun<'a> {
    pub(crate) given: RunInput<'a>,
    /// Its drive, with the edges where they are taken to be.
    pub(crate) edges: EdgeTimes,
    /// What is not known of the offset of a clock that the bending has of its own, one standard deviation, s; 0 where it has none.
    bending_error_s: f64,
    /// What is left open of the zeros and drifts of its instruments, taken out of its whitened residuals.
    pub(crate) open_zeros: LeftOpen,
    /// Likewise of the edges, and of that offset.
    pub(crate) open_edges: LeftOpen,
    /// Likewise of its own parameters, where runs scatter.
    pub(crate) open_parameters: LeftOpen,
    pub(crate) duration_s: f64,
    /// Current and curvature.
    pub(crate) channels: [Option<WhitenedChannel>; 2],
    /// Times of all readings of current and curvature that are left out, s.
    pub(crate) left_out_s: [Vec<f64>; 2],
    /// Times at which models were stepped.
    grids: Arc<Grids>,
}

/// Consecutive rows of the whitened residuals that belong to one channel of one run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Block {
    pub(crate) run: usize,
    /// 0 for current, 1 for curvature.
    pub(crate) channel: usize,
    pub(crate) first: usize,
    pub(crate) end: usize,
}

/// Runs of one sample in one condition, described by one parameter set.
#[derive(Debug, Clone)]
pub(crate) struct RunGroup<'a> {
    pub(crate) runs: Vec<GroupRun<'a>>,
    /// Whether slow noise is taken even where the readings alone do not ask for it.
    is_slow: bool,
    /// What runs scatter by, where that was looked at.
    scatter: Option<Scatter>,
    pub(crate) blocks: Vec<Block>,
}

pub(crate) const QUANTITIES: [Quantity; 2] = [Quantity::Current, Quantity::Curvature];

/// What a channel is called in sentences.
pub(crate) fn channel_name(channel: usize) -> &'static str {
    ["current", "curvature"][channel]
}

impl<'a> RunGroup<'a> {
    /// Runs with at least one usable channel, in the order given.
    pub(crate) fn new(given: &[RunInput<'a>]) -> RunGroup<'a> {
        let runs: Vec<GroupRun> = given.iter().filter_map(GroupRun::new).collect();
        let blocks = RunGroup::blocks(&runs);
        RunGroup {
            runs,
            blocks,
            is_slow: false,
            scatter: None,
        }
    }

    /// The same readings with slow noise beside the white; none where that was taken before.
    pub(crate) fn with_slow_noise(&self, model: &ExtendedModel) -> Option<RunGroup<'a>> {
        let slow = RunGroup {
            is_slow: true,
            ..self.clone()
        };
        (!self.is_slow).then(|| slow.renoised(model))
    }

    /// The same readings with the noise that is left beside every run's own parameters, and with what these scatter by taken
    /// as noise too; none of fewer runs than tell a scatter, and where it was looked at before.
    pub(crate) fn with_scatter(&self, model: &ExtendedModel) -> Option<RunGroup<'a>> {
        if self.scatter.is_some() {
            return None;
        }
        let free = RunGroup {
            scatter: Some(Scatter::most(self, model)?),
            ..self.clone()
        };
        // Once more: the noise of a first look holds a part of what differs.
        Some(free.renoised(model).renoised(model))
    }

    /// The runs of each drive, in their order.
    pub(crate) fn drives(&self) -> Vec<Vec<usize>> {
        let are_alike = |a: &GroupRun, b: &GroupRun| a.drive().repeats(b.drive());
        self.families(&are_alike)
    }

    /// Repeats: the runs of each drive in one place among the tags, in their order, where there are several. What differs with a
    /// tag is no scatter.
    pub(crate) fn repeats(&self) -> Vec<Vec<usize>> {
        let are_alike =
            |a: &GroupRun, b: &GroupRun| a.drive().repeats(b.drive()) && a.given.tags == b.given.tags;
        let mut found = self.families(&are_alike);
        found.retain(|runs| runs.len() > 1);
        found
    }

    fn families(&self, are_alike: &dyn Fn(&GroupRun, &GroupRun) -> bool) -> Vec<Vec<usize>> {
        let mut families: Vec<Vec<usize>> = Vec::new();
        for (run, own) in self.runs.iter().enumerate() {
            match families
                .iter_mut()
                .find(|runs| are_alike(&self.runs[runs[0]], own))
            {
                Some(runs) => runs.push(run),
                None => families.push(vec![run]),
            }
        }
        families
    }

    /// What was found of the scatter from run to run, where it was looked at.
    pub(crate) fn scatter(&self) -> Option<&Scatter> {
        self.scatter.as_ref()
    }

    /// The model of each run: that of the group, and where scatter was looked for with the run's own deviations.
    pub(crate) fn own_models(&self, model: &ExtendedModel) -> Vec<ExtendedModel> {
        match &self.scatter {
            Some(scatter) => scatter.own_models(self, model),
            None => vec![model.clone(); self.runs.len()],
        }
    }

    /// Finds anew how the scatter of the parameters changes the whitened rows.
    fn open_parameters_beside(&mut self, model: &ExtendedModel) {
        let Some(scatter) = &self.scatter else { return };
        let each = 0..self.runs.len();
        let open: Vec<LeftOpen> = each.map(|run| left_open(self, model, run, scatter)).collect();
        self.runs
            .iter_mut()
            .zip(open)
            .for_each(|(run, open)| run.open_parameters = open);
    }

    /// The rows of those runs, one channel after the other.
    pub(crate) fn blocks(runs: &[GroupRun]) -> Vec<Block> {
        let mut blocks = Vec::new();
        let mut row = 0;
        for (run, group_run) in runs.iter().enumerate() {
            for (channel, whitened) in group_run.channels.iter().enumerate() {
                let Some(whitened) = whitened else { continue };
                let (first, end) = (row, row + whitened.len());
                row = end;
                blocks.push(Block {
                    run,
                    channel,
                    first,
                    end,
                });
            }
        }
        blocks
    }

    /// The same readings with the noise that `model` leaves. A channel whose memory cannot be told from its misfit
    /// (short stretches, and a correlation beyond all others of its kind) takes that of the middle run.
    pub(crate) fn renoised(&self, model: &ExtendedModel) -> RunGroup<'a> {
        let mut group = self.clone();
        let own = self
            .scatter
            .as_ref()
            .map(|scatter| scatter.own_models(self, model));
        let model_of = |run: usize| own.as_ref().map_or(model, |own| &own[run]);
        let fitted: Vec<[Vec<f64>; 2]> = (self.runs.iter().enumerate())
            .map(|(index, run)| run.fitted(model_of(index), &run.context(index, None)))
            .collect();
        for kind in 0..2 {
            let per_signal = self.growth(kind, &fitted);
            for (run, fitted) in group.runs.iter_mut().zip(&fitted) {
                run.channels[kind] = run.channels[kind]
                    .as_ref()
                    .map(|c| c.renoised(&fitted[kind], per_signal, None));
            }
            let middle = group.middle(kind);
            for (run, fitted) in group.runs.iter_mut().zip(&fitted) {
                let Some(channel) = &run.channels[kind] else {
                    continue;
                };
                let likened = middle.as_ref().filter(|middle| {
                    let usual = middle.readings_per_independent().max(2.0);
                    channel.readings_per_independent() > MEMORY_BEYOND_USUAL * usual
                });
                run.channels[kind] = Some(match likened {
                    Some(_) => channel.renoised(&fitted[kind], per_signal, likened),
                    None => channel.forgetting(&fitted[kind], per_signal, LONGEST_MEMORY_READINGS),
                });
            }
            group.share_correlation(kind, per_signal, &fitted);
            group.take_slow_noise(kind, per_signal, &fitted);
        }
        group.open_zeros_beside(&fitted);
        group.open_edges_beside(model);
        group.scatter = self.scatter.as_ref().map(|_| Scatter::found(&group, model));
        group.open_parameters_beside(model);
        group
    }

    /// Finds anew how what is not known of the edges changes the whitened rows.
    fn open_edges_beside(&mut self, model: &ExtendedModel) {
        for (index, run) in self.runs.iter_mut().enumerate() {
            if run.edges.is_open() || run.bending_error_s > 0.0 {
                run.open_edges = run.open_edges_beside(model, index);
            }
        }
    }

    /// Gives the channels of that kind one correlation where all of their noises have it that have one at all: one
    /// instrument wrote them, and of slow noise each run alone knows little.
    fn share_correlation(&mut self, kind: usize, per_signal: f64, fitted: &[[Vec<f64>; 2]]) {
        let channels: Vec<&WhitenedChannel> = self
            .runs
            .iter()
            .filter_map(|run| run.channels[kind].as_ref())
            .filter(|channel| channel.tells_correlation())
            .collect();
        if !are_alike(&channels) {
            return;
        }
        let Some(correlation) = WhitenedChannel::shared_correlation(&channels) else {
            return;
        };
        let among = channels.len();
        for (run, fitted) in self.runs.iter_mut().zip(fitted) {
            if let Some(channel) = run.channels[kind].as_mut().filter(|c| c.tells_correlation()) {
                *channel = channel.sharing(&fitted[kind], per_signal, correlation, among);
            }
        }
    }

    /// Gives the channels of that kind slow noise beside the white where all of them together ask for it.
    fn take_slow_noise(&mut self, kind: usize, per_signal: f64, fitted: &[[Vec<f64>; 2]]) {
        let of_kind = self.runs.iter().zip(fitted);
        let (channels, fitted): (Vec<&WhitenedChannel>, Vec<&[f64]>) = of_kind
            .filter_map(|(run, fitted)| Some((run.channels[kind].as_ref()?, fitted[kind].as_slice())))
            .unzip();
        if !are_alike(&channels) {
            return;
        }
        let worth = if self.is_slow {
            f64::NEG_INFINITY
        } else {
            SLOW_WORTH
        };
        let slow = WhitenedChannel::with_slow_noise(&channels, &fitted, per_signal, worth, GROWTH_EVIDENCE);
        let Some(slow) = slow else {
            return;
        };
        let own = self.runs.iter_mut().filter_map(|run| run.channels[kind].as_mut());
        own.zip(slow).for_each(|(channel, slow)| *channel = slow);
    }

    /// How the noise of that kind of channel grows with the signal, per signal; 0 where the readings do not ask for it.
    /// All runs are asked together: one instrument wrote them, and in one run the signal is large in few readings.
    fn growth(&self, kind: usize, fitted: &[[Vec<f64>; 2]]) -> f64 {
        let peak = fitted
            .iter()
            .map(|fitted| sums::peak(&fitted[kind]))
            .fold(0.0, f64::max);
        if peak <= 0.0 {
            return 0.0;
        }
        let tried: Vec<f64> = GROWTHS.iter().map(|growth| growth / peak).collect();
        let mut against = vec![0.0; tried.len()];
        let (mut slowness, mut channels) = (0.0, 0.0_f64);
        for (run, fitted) in self.runs.iter().zip(fitted) {
            let Some(channel) = &run.channels[kind] else {
                continue;
            };
            for (sum, own) in against
                .iter_mut()
                .zip(channel.against_growth(&fitted[kind], &tried))
            {
                *sum += own;
            }
            let readings = channel.readings_per_independent().max(1.0);
            slowness += (readings * readings + 1.0) / (2.0 * readings);
            channels += 1.0;
        }
        // Squares of correlated noise wander together: their evidence counts for less.
        let needed = GROWTH_EVIDENCE * slowness / channels.max(1.0);
        let best = (0..tried.len()).min_by(|&a, &b| against[a].total_cmp(&against[b]));
        best.filter(|&k| against[k] < -needed).map_or(0.0, |k| tried[k])
    }

    /// The channel of that kind with the middle memory.
    fn middle(&self, kind: usize) -> Option<WhitenedChannel> {
        let mut channels: Vec<&WhitenedChannel> = self
            .runs
            .iter()
            .filter_map(|run| run.channels[kind].as_ref())
            .collect();
        channels.sort_by(|a, b| {
            a.readings_per_independent()
                .total_cmp(&b.readings_per_independent())
        });
        // Of an even number the shorter: a misfit makes memories longer, nothing makes them shorter.
        channels
            .get(channels.len().saturating_sub(1) / 2)
            .filter(|_| channels.len() > 1)
            .map(|channel| (*channel).clone())
    }

    /// Number of rows of whitened residuals.
    pub(crate) fn rows(&self) -> usize {
        self.blocks.last().map_or(0, |block| block.end)
    }

    /// The rows of one run.
    pub(crate) fn rows_of(&self, run: usize) -> Range<usize> {
        let mut own = self.blocks.iter().filter(|block| block.run == run);
        let first = own.next().map_or(0..0, |block| block.first..block.end);
        own.fold(first, |rows, block| rows.start..block.end)
    }

    /// Takes what is not known of each run out of whitened rows of all of them.
    pub(crate) fn take_out(&self, rows: &mut [f64]) {
        for (run, rows) in self.runs.iter().zip(self.by_run(rows)) {
            run.take_out(rows);
        }
    }

    /// Gives it back.
    pub(crate) fn put_back(&self, rows: &mut [f64]) {
        for (run, rows) in self.runs.iter().zip(self.by_run(rows)) {
            run.open_parameters.put_back(rows);
            run.open_edges.put_back(rows);
            run.open_zeros.put_back(rows);
        }
    }

    /// The rows of each run.
    fn by_run<'r>(&self, mut rows: &'r mut [f64]) -> Vec<&'r mut [f64]> {
        let of_run = |run: &GroupRun| {
            let channels = run.channels.iter().flatten().map(WhitenedChannel::len);
            let (own, rest) = std::mem::take(&mut rows).split_at_mut(channels.sum());
            rows = rest;
            own
        };
        self.runs.iter().map(of_run).collect()
    }

    pub(crate) fn channel(&self, block: &Block) -> Option<&WhitenedChannel> {
        self.runs[block.run].channels[block.channel].as_ref()
    }

    /// Whether any run measures curvature.
    pub(crate) fn bends(&self) -> bool {
        self.blocks.iter().any(|block| block.channel == 1)
    }

    /// Independent readings that all channels together carry.
    pub(crate) fn effective_readings(&self) -> f64 {
        let of_block = |block: &Block| {
            let channel = self.channel(block);
            channel.map_or(0.0, |c| c.len() as f64 / c.readings_per_independent())
        };
        self.blocks.iter().map(of_block).sum()
    }
}

/// Whether all channels are read at one distance: a correlation of neighbours is then one of time.
fn are_alike(channels: &[&WhitenedChannel]) -> bool {
    let steps: Vec<f64> = channels.iter().map(|channel| usual_step_s(channel)).collect();
    let shortest_s = steps.iter().copied().fold(f64::INFINITY, f64::min);
    steps
        .iter()
        .all(|step_s| *step_s <= SAME_STEP_FACTOR * shortest_s)
}

/// The middle one of the steps of time between readings, s.
fn usual_step_s(channel: &WhitenedChannel) -> f64 {
    median_step(channel.time_s()).unwrap_or(0.0)
}

impl<'a> GroupRun<'a> {
    fn new(given: &RunInput<'a>) -> Option<GroupRun<'a>> {
        let edges = EdgeTimes::of(&followed(given.input.drive));
        let cleaned = without_outliers(given.input.channels, given.input.drive);
        let input = FitInput {
            channels: &cleaned.channels,
            ..given.input
        };
        // Where nothing tells the offset the fit of the run says so.
        let aligned = aligned(&input, &FitOptions::default()).unwrap_or_default();
        let on_one_clock = aligned
            .as_ref()
            .map_or(input.channels, |aligned| &aligned.channels);
        let place = |k: usize| {
            on_one_clock
                .iter()
                .position(|channel| channel.is_whole(QUANTITIES[k]))
        };
        let channels = std::array::from_fn(|k| {
            let channel = &on_one_clock[place(k)?];
            WhitenedChannel::new(channel, edges.drive(), FEWEST_READINGS, MOST_READINGS)
        });
        let left_out_s = std::array::from_fn(|k| {
            place(k).map_or_else(Vec::new, |place| cleaned.left_out_s[place].clone())
        });
        let last_s = |channel: &WhitenedChannel| channel.time_s().last().copied().unwrap_or(0.0);
        let duration_s = channels.iter().flatten().map(last_s).fold(0.0, f64::max);
        channels.iter().any(Option::is_some).then_some(GroupRun {
            given: *given,
            edges,
            bending_error_s: aligned.map_or(0.0, |aligned| aligned.error_s()),
            open_zeros: LeftOpen::default(),
            open_edges: LeftOpen::default(),
            open_parameters: LeftOpen::default(),
            duration_s,
            channels,
            left_out_s,
            grids: Arc::default(),
        })
    }

    /// How many of its readings are left out.
    pub(crate) fn left_out(&self) -> usize {
        self.left_out_s.iter().map(Vec::len).sum()
    }

    /// Its drive, with the edges where they are taken to be.
    pub(crate) fn drive(&self) -> &Drive {
        self.edges.drive()
    }

    /// What a fit of the run alone takes, with the edges where they are taken to be.
    pub(crate) fn input(&self) -> FitInput<'_> {
        FitInput {
            drive: self.drive(),
            ..self.given.input
        }
    }

    /// Current and curvature of a model at the values of both channels.
    pub(crate) fn fitted(&self, model: &ExtendedModel, context: &RunContext) -> [Vec<f64>; 2] {
        let nodes_s = |k: usize| {
            self.channels[k]
                .as_ref()
                .map_or(&[][..], WhitenedChannel::nodes_s)
        };
        let found = model.responses_by(&self.grids, context, nodes_s(0), nodes_s(1));
        let at_nodes = [found.current_a, found.curvature_per_cm];
        std::array::from_fn(|k| {
            let channel = self.channels[k].as_ref();
            channel.map_or_else(Vec::new, |channel| channel.over_nodes(&at_nodes[k]).into_owned())
        })
    }

    /// Measured minus `fitted` of both channels, white and in standard deviations, appended.
    pub(crate) fn whitened(&self, fitted: &[Vec<f64>; 2], out: &mut Vec<f64>) {
        for (channel, fitted) in self.channels.iter().zip(fitted) {
            if let Some(channel) = channel {
                channel.residuals(fitted, out);
            }
        }
    }

    /// Takes what is not known of the run beyond its group's model out of its whitened rows.
    pub(crate) fn take_out(&self, rows: &mut [f64]) {
        self.take_out_of_readings(rows);
        self.open_parameters.take_out(rows);
    }

    /// The same but for its own parameters.
    pub(crate) fn take_out_of_readings(&self, rows: &mut [f64]) {
        self.open_zeros.take_out(rows);
        self.open_edges.take_out(rows);
    }

    fn open_edges_beside(&self, model: &ExtendedModel, index: usize) -> LeftOpen {
        let fitted = |drive: &Drive| {
            let mut context = self.context(index, None);
            context.drive = drive;
            self.fitted(model, &context)
        };
        let rows = |fitted: &[Vec<f64>; 2]| {
            let mut out = Vec::new();
            self.whitened(fitted, &mut out);
            out
        };
        let still = fitted(self.drive());
        let here = rows(&still);
        let change = |there: &[Vec<f64>; 2]| -> Vec<f64> {
            let there = rows(there);
            let pairs = here.iter().zip(&there);
            let mut change: Vec<f64> = pairs.map(|(here, there)| (there - here) / SLOPE).collect();
            self.open_zeros.take_out(&mut change);
            change
        };
        let of_way = |way: Vec<f64>| {
            let by_s: Vec<f64> = way.iter().map(|by_s| SLOPE * by_s).collect();
            change(&fitted(&self.edges.shifted(&by_s)))
        };
        let of_clock = (self.bending_error_s > 0.0).then(|| {
            let [_, bent] = fitted(&self.drive().later(SLOPE * self.bending_error_s));
            change(&[still[0].clone(), bent])
        });
        LeftOpen::of(self.edges.open_ways().into_iter().map(of_way).chain(of_clock))
    }

    pub(crate) fn context(&self, index: usize, resolved_s: Option<f64>) -> RunContext<'_> {
        RunContext {
            index,
            drive: self.drive(),
            area_cm2: self.given.input.area_cm2,
            length_cm: self.given.length_cm,
            duration_s: self.duration_s,
            resolved_s,
            tags: self.given.tags,
            channels: self.given.input.channels,
        }
    }

    pub(crate) fn times(&self, channel: usize) -> &[f64] {
        self.channels[channel].as_ref().map_or(&[], |c| c.time_s())
    }
}
