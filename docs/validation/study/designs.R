# Ten designs with the answers of lme4 and emmeans (Kenward and Roger), for the mixed model of the study.
#   Rscript docs/validation/study/designs.R     writes designs.csv and answers.csv beside this file
suppressMessages({library(lme4); library(emmeans); library(pbkrtest)})
emm_options(lmer.df = "kenward-roger")
here <- dirname(sub("--file=", "", grep("--file=", commandArgs(FALSE), value = TRUE)))
designs <- list(
  list(samples = 2, environments = 3, voltages = 3, repeats = 1, sd = c(0.3, 0.2, 0.05)),
  list(samples = 3, environments = 2, voltages = 2, repeats = 2, sd = c(0.2, 0.1, 0.05)),
  list(samples = 4, environments = 3, voltages = 2, repeats = 1, sd = c(0.3, 0.15, 0.1)),
  list(samples = 5, environments = 2, voltages = 1, repeats = 3, sd = c(0.1, 0.2, 0.1)),
  list(samples = 6, environments = 4, voltages = 3, repeats = 2, sd = c(0.4, 0.1, 0.2)),
  list(samples = 8, environments = 2, voltages = 2, repeats = 1, sd = c(0.2, 0.3, 0.1), lost = 0.2),
  list(samples = 4, environments = 3, voltages = 3, repeats = 2, sd = c(0.3, 0.2, 0.1), lost = 0.3),
  list(samples = 10, environments = 3, voltages = 1, repeats = 2, sd = c(0.2, 0.2, 0.2), lost = 0.15),
  list(samples = 3, environments = 3, voltages = 4, repeats = 3, sd = c(0.5, 0.3, 0.02), lost = 0.1),
  list(samples = 12, environments = 2, voltages = 3, repeats = 1, sd = c(0.1, 0.05, 0.3), lost = 0.1))
rows <- NULL; answers <- NULL
for (k in seq_along(designs)) {
  d <- designs[[k]]; set.seed(1000 + k)
  all <- expand.grid(replicate = 1:d$repeats, voltage = 1:d$voltages, environment = 1:d$environments, sample = 1:d$samples)
  own <- rnorm(d$samples, 0, d$sd[1])
  both <- matrix(rnorm(d$samples * d$environments, 0, d$sd[2]), d$samples)
  all$y <- 0.4 * all$environment - 0.2 * all$voltage + own[all$sample] +
    both[cbind(all$sample, all$environment)] + rnorm(nrow(all), 0, d$sd[3])
  all$y <- round(all$y, 6)
  if (!is.null(d$lost)) all <- all[runif(nrow(all)) > d$lost, ]
  all$design <- k
  rows <- rbind(rows, all[, c("design", "sample", "environment", "voltage", "y")])
  f <- within(all, {sample <- factor(sample); environment <- factor(environment); voltage <- factor(voltage)})
  formula <- if (d$voltages > 1) y ~ environment * voltage + (1 | sample) + (1 | sample:environment) else
    y ~ environment + (1 | sample) + (1 | sample:environment)
  fit <- lmer(formula, f, REML = TRUE, control = lmerControl(optimizer = "bobyqa", optCtrl = list(rhoend = 1e-10, maxfun = 1e5)))
  found <- as.data.frame(pairs(emmeans(fit, "environment"), reverse = TRUE))
  v <- as.data.frame(VarCorr(fit))
  of <- function(group) v$vcov[v$grp == group]
  answers <- rbind(answers, data.frame(design = k, contrast = gsub("environment", "", found$contrast),
    estimate = found$estimate, standard_error = found$SE, degrees_of_freedom = found$df,
    variance_sample = of("sample"), variance_sample_environment = of("sample:environment"), variance_reading = of("Residual"),
    restricted_log_likelihood = as.numeric(logLik(fit)), singular = isSingular(fit)))
}
write.csv(rows, file.path(here, "designs.csv"), row.names = FALSE, quote = FALSE)
write.csv(format(answers, digits = 12, scientific = FALSE, trim = TRUE), file.path(here, "answers.csv"), row.names = FALSE, quote = FALSE)
